#pragma once

#include "editor/edits/support.h"
#include "mesh_ops/fill/filled_holes.h"
#include "mesh_ops/fill/hole_patch.h"

namespace rebake {

/// Appends what filling the holes of a node did. `longest`: as for unfilled_words().
void report_filling(const PlacedNode& placed, const FilledHoles& filled, Report& report,
                    std::size_t longest = longest_loop);

/// Why holes stay open: "2 have more than 8 edges, 1 crosses itself". `longest`: edges of the longest that are wanted.
std::string unfilled_words(const FilledHoles& filled, std::size_t longest);

/// Gives a node its filled object. The patches come last, so stored selections, which do not contain them, only grow.
void set_filled(Node& node, const FilledHoles& filled);

}  // namespace rebake
