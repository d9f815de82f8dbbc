#pragma once

#include <vector>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// An object's faces by the turn that all their corners have.
struct TurnGroups {
  struct Group {
    Mat3 turn;
    std::size_t faces = 0;
  };
  static constexpr std::uint32_t bent = 0xffffffff;
  std::vector<Group> groups;
  std::vector<std::uint32_t> group_of;  ///< a face, through the object's sets; bent where its corners differ
  bool any_bent = false;
};

/// Beside bent faces, a few (below 1 %) that happen to be turned alike count as bent.
TurnGroups turn_groups(const BakedObject& object);

/// Equal but for the rounding of a folded rotation.
bool nearly_equal(const Decoder& a, const Decoder& b);

}  // namespace rebake
