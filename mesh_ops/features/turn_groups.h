#pragma once

#include <vector>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// An object's faces grouped by the rotation that all their corners share.
struct TurnGroups {
  struct Group {
    Mat3 turn;
    std::size_t faces = 0;
  };
  static constexpr std::uint32_t bent = 0xffffffff;
  std::vector<Group> groups;
  std::vector<std::uint32_t> group_of;  ///< per face, in the order of sets; `bent` if its corners differ
  bool any_bent = false;
};

/// Groups of fewer than 1 % of the faces count as bent if there are bent faces.
TurnGroups turn_groups(const BakedObject& object);

/// Equal up to the rounding of a folded rotation.
bool nearly_equal(const Decoder& a, const Decoder& b);

}  // namespace rebake
