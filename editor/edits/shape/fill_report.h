#pragma once

#include "editor/edits/support.h"
#include "mesh_ops/fill/filled_holes.h"

namespace rebake {

/// Appends what filling the holes of a node did.
void report_filling(const std::string& node, const FilledHoles& filled, Report& report);

/// The note that holes of a node stay open.
std::string unfilled_words(const std::string& node, std::size_t holes);

/// Gives a node its filled object. The patches come last, so stored selections, which do not contain them, only grow.
void set_filled(Node& node, const FilledHoles& filled);

}  // namespace rebake
