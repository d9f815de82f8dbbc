#pragma once

#include <vector>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// An object's faces grouped by the rotation that all their corners share.
struct RotationGroups {
  struct Group {
    Mat3 turn;
    std::size_t faces = 0;  ///< number of faces
  };
  /// Group of faces whose corners have different rotations.
  static constexpr std::uint32_t bent = 0xffffffff;
  std::vector<Group> groups;
  std::vector<std::uint32_t> group_of;  ///< per face, in the order of sets: index in `groups`, or `bent`
  bool any_bent = false;
};

/// Groups the faces. If any face is bent, groups of fewer than 1 % of the faces count as bent too.
RotationGroups rotation_groups(const BakedObject& object);

/// Whether two decoders are equal up to the rounding of a rotation that was folded into their weights.
bool nearly_equal(const Decoder& a, const Decoder& b);

}  // namespace rebake
