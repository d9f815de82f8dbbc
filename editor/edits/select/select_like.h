#pragma once

#include "editor/edits/select/selecting.h"

namespace rebake {

/// Selects triangles that are similar to a reference: the mean of the present selection, or the triangle nearest to a
/// point. A triangle must be within all given tolerances.
struct SelectLike {
  static constexpr const char* op = "select_like";
  static constexpr bool selects = true;
  static constexpr AdjustableField adjustable[] = {{"color", "Tolerance", AdjustableField::Kind::factor}};
  std::optional<NodeRef> node;  ///< nothing: all visible, unlocked objects
  std::optional<Vec3> point;    ///< in world space; nothing: the present selection is the reference
  std::optional<double> color, features, opacity, size, orientation;  ///< tolerances, see AppearanceBounds
  bool contiguous = false;  ///< only triangles connected to the reference through shared vertices
  SelectMode mode = SelectMode::set;
};
template <>
const EditType& edit_type<SelectLike>();

Scene apply(const Scene& scene, const SelectLike& edit);

}  // namespace rebake
