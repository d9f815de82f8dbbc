#pragma once

#include "editor/edits/select/selecting.h"

namespace rebake {

/// Selects triangles that are like the picked ones: within every tolerance that is given, of the mean over the
/// present selection or of the triangle nearest to a point.
struct SelectLike {
  static constexpr const char* op = "select_like";
  static constexpr bool selects = true;
  std::optional<NodeRef> node;
  std::optional<Vec3> point;
  std::optional<double> color, features, opacity, size, orientation;
  bool contiguous = false;
  SelectMode mode = SelectMode::set;
};
template <>
const EditType& edit_type<SelectLike>();

Scene apply(const Scene& scene, const SelectLike& edit);

}  // namespace rebake
