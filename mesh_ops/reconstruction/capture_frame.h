#pragma once

#include <string>
#include <vector>

#include "mesh_ops/reconstruction/grid_space.h"
#include "mesh_ops/refit/photograph_fit.h"

namespace rebake {

/// The normalised frame of a capture.
struct CaptureFrame {
  Affine to_unit = Affine::Identity();  ///< similarity from the scene
  Vec3 background = Vec3::Ones();       ///< display colour behind everything
  /// Exposures of the photographs (gains per channel, in linear light) by their backgrounds; empty if these agree.
  std::vector<Vec3> gains = {};
  Frustum frustum = {};                 ///< of a forward capture
  std::vector<std::string> notes = {};  ///< how it was found
};

/// The frame of an object: the cube around all that is not background, by silhouettes. Photographs of an even
/// background have nearly one colour along their borders; if it is the same in all, it becomes `background`; if it
/// differs, so do exposures. Without an even background, the cube is what the cameras see around the point they look
/// at. `background`: where photographs are transparent. `margin`: cells at each side of the grid that stay free, as a
/// share of its side.
CaptureFrame object_frame(const std::vector<FitPhotograph>& photographs, const Vec3& background, double margin);

/// The frame of a forward-facing capture: mean pose of the cameras, the nearest depth at 4/3 (as published). `near`,
/// `far`: depths in scene units; 0: those that camera files state, else half and ten times the distance of the point
/// that the cameras look at. Throws Error for cameras that look in opposite directions.
CaptureFrame forward_frame(const std::vector<FitPhotograph>& photographs, double near, double far);

/// The frame of an unbounded scene: the cube around the cameras, with their mean upward direction as z.
CaptureFrame unbounded_frame(const std::vector<FitPhotograph>& photographs);

}  // namespace rebake
