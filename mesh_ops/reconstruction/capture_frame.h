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
  std::vector<std::string> notes = {};  ///< how it was found
};

/// The frame of an object: the cube around all that is not background, by silhouettes. Photographs of an even
/// background have nearly one colour along their borders; if it is the same in all, it becomes `background`; if it
/// differs, so do exposures. Without an even background, the cube is what the cameras see around the point they look
/// at. `background`: where photographs are transparent. `margin`: cells at each side of the grid that stay free, as a
/// share of its side.
CaptureFrame object_frame(const std::vector<FitPhotograph>& photographs, const Vec3& background, double margin);

}  // namespace rebake
