#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Sets the scene's ground plane: nodes drop onto it and snap to it, and its normal is the up direction of sky light.
/// Exactly one of the fields must be given.
struct GroundEdit {
  static constexpr const char* op = "ground";
  std::optional<double> height;  ///< level plane at this y
  bool foot = false;             ///< level plane at the lowest point of all visible objects
  bool selection = false;        ///< least-squares plane of the selected triangles
  std::vector<NodeRef> nodes;    ///< with `selection`: only triangles of these nodes; empty: of all
  PolyLine points;               ///< plane through three points
};
template <>
const EditType& edit_type<GroundEdit>();

Outcome apply(const Scene& scene, const GroundEdit& edit);
/// Title of a step: see EditType::title.
std::string whole_title(const GroundEdit& edit);

}  // namespace rebake
