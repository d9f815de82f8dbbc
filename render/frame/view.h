#pragma once

#include "mesh_ops/scene/camera.h"

namespace rebake {

/// What to show: the camera and the picture's raster.
struct View {
  Camera camera;
  int width = 800;
  int height = 800;
  int samples = 4;  ///< a pixel: 1, 4 or 16, on a regular grid
};

/// Throws FieldError unless the size is 1 … 16384 a side, samples is 1, 4 or 16 and the camera is sound.
void check(const View& view);

}  // namespace rebake
