#pragma once

#include "mesh_ops/scene/camera.h"

namespace rebake {

/// What to show: the camera and the picture's raster.
struct View {
  Camera camera;
  int width = 800;
  int height = 800;
  int samples = 4;  ///< a pixel, on a regular grid: 1, 4 or 16; 64 for references

  /// Samples along a pixel's side.
  int side() const { return samples == 1 ? 1 : samples == 4 ? 2 : samples == 16 ? 4 : 8; }
};

/// Throws FieldError unless the size is 1 … 16384 a side, samples is 1, 4, 16 or 64 and the camera is sound.
void check(const View& view);

}  // namespace rebake
