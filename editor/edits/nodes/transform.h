#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Scales, then turns, then moves a node or its selected triangles about a pivot.
struct Transform {
  static constexpr const char* op = "transform";
  NodeRef node;
  bool selection = false;
  Vec3 translate{0, 0, 0};
  Rotation rotate;
  Scale scale;
  Rotation scale_axes;
  std::optional<Vec3> pivot;
};
template <>
const EditType& edit_type<Transform>();

Scene apply(const Scene& scene, const Transform& edit);

}  // namespace rebake
