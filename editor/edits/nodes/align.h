#pragma once

#include "editor/edits/support.h"
#include "editor/fields/codec.h"

namespace rebake {

/// Axis of world space.
enum class WorldAxis { x, y, z };
/// Alignment along an axis: lower ends, centres or upper ends of the world boxes at those of the first node, or equal
/// gaps between neighbours (spread).
enum class AlignTo { least, middle, greatest, spread };
REBAKE_CODEC(WorldAxis);
REBAKE_CODEC(AlignTo);

/// Aligns the world boxes of nodes along an axis with the first node, or distributes them with equal gaps.
struct Align {
  static constexpr const char* op = "align";
  static constexpr const char* done = "Aligned";
  std::vector<NodeRef> nodes;  ///< two or more, none inside another
  WorldAxis axis = WorldAxis::x;
  AlignTo to = AlignTo::middle;
};
template <>
const EditType& edit_type<Align>();

Scene apply(const Scene& scene, const Align& edit);

}  // namespace rebake
