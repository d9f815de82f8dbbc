#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// How a node stands in its parent: its linear part is rotation · shear · diag(scale); nodes that were only moved,
/// turned and scaled along their own axes have no shear.
struct Placement {
  Vec3 position{0, 0, 0};
  Mat3 rotation = Mat3::Identity();  ///< det 1
  Vec3 scale{1, 1, 1};               ///< one is negative where the node is mirrored
  Mat3 shear = Mat3::Identity();     ///< symmetric, with a diagonal of 1
  bool sheared = false;              ///< by more than rounding
};
Placement placement_of(const Affine& to_parent);

/// Says where a node stands, how it is turned and how large it is, in its parent. What is left out stays.
struct Place {
  static constexpr const char* op = "place";
  NodeRef node;
  std::optional<Vec3> position;
  std::optional<Rotation> rotation;
  std::optional<Scale> scale;
};
template <>
const EditType& edit_type<Place>();

Scene apply(const Scene& scene, const Place& edit);

}  // namespace rebake
