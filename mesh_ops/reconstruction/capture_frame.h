#pragma once

#include <string>
#include <vector>

#include "mesh_ops/reconstruction/grid_space.h"
#include "mesh_ops/refit/photograph_fit.h"

namespace rebake {

/// The normalised frame of a capture.
struct CaptureFrame {
  Affine to_unit = Affine::Identity();  ///< similarity from the scene
  std::vector<std::string> notes = {};  ///< how it was found
};

/// The frame of an object: the cube around what is not background. Where no photograph has an even background
/// (`background`, or the colour of nearly all border pixels), the cube is what the cameras see around the point they
/// look at. `margin`: cells at each side of the grid that stay free, as a share of its side.
CaptureFrame object_frame(const std::vector<FitPhotograph>& photographs, const Vec3& background, double margin);

}  // namespace rebake
