#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Sets the scene's ground plane: what nodes drop onto and snap to, and up for sky light.
struct GroundEdit {
  static constexpr const char* op = "ground";
  std::optional<double> height;  ///< level, at this y
  bool foot = false;             ///< level, at the foot of everything visible
  bool selection = false;        ///< fitted to the selected triangles
  PolyLine points;               ///< through three points
};
template <>
const EditType& edit_type<GroundEdit>();

Outcome apply(const Scene& scene, const GroundEdit& edit);

}  // namespace rebake
