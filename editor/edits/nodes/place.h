#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Decomposition of a node's transform to its parent: translation, and a linear part rotation · shear · diag(scale).
/// Nodes that were only translated, rotated and scaled along their own axes have no shear.
struct Placement {
  Vec3 position{0, 0, 0};
  Mat3 rotation = Mat3::Identity();  ///< proper rotation, det 1
  Vec3 scale{1, 1, 1};               ///< one or three factors are negative if the node is mirrored
  Mat3 shear = Mat3::Identity();     ///< unit diagonal
  bool sheared = false;              ///< the shear is above rounding error
};
/// Throws std::invalid_argument for a singular transform.
Placement placement_of(const Affine& to_parent);

/// Sets a node's position, rotation and scale relative to its parent. Absent fields keep their values; at least one
/// must be given.
struct Place {
  static constexpr const char* op = "place";
  static constexpr const char* done = "Placed";
  NodeRef node;
  std::optional<Vec3> position;
  std::optional<Rotation> rotation;
  std::optional<Scale> scale;
};
template <>
const EditType& edit_type<Place>();

Outcome apply(const Scene& scene, const Place& edit);

}  // namespace rebake
