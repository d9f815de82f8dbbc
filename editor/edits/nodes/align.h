#pragma once

#include "editor/edits/support.h"
#include "editor/fields/codec.h"

namespace rebake {

enum class WorldAxis { x, y, z };
/// Where nodes are put beside each other along an axis.
enum class AlignTo { least, middle, greatest, spread };
REBAKE_CODEC(WorldAxis);
REBAKE_CODEC(AlignTo);

/// Moves nodes along an axis so that their boxes' ends or middles are at the first one's, or with the same gap between
/// neighbours.
struct Align {
  static constexpr const char* op = "align";
  std::vector<NodeRef> nodes;
  WorldAxis axis = WorldAxis::x;
  AlignTo to = AlignTo::middle;
};
template <>
const EditType& edit_type<Align>();

Scene apply(const Scene& scene, const Align& edit);

}  // namespace rebake
