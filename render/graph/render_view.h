#pragma once

#include "mesh_ops/scene/camera.h"

namespace rebake {

/// A camera and the raster of its picture.
struct View {
  Camera camera;
  int width = 800;   ///< pixels
  int height = 800;  ///< pixels
  int samples = 4;   ///< per pixel, on a regular grid: 1, 4 or 16; 64 for references

  /// Samples per pixel side: the square root of `samples`.
  int side() const { return samples == 1 ? 1 : samples == 4 ? 2 : samples == 16 ? 4 : 8; }
};

/// Throws FieldError unless the size is 1 … 16384 pixels per side, samples is 1, 4, 16 or 64, and the camera is valid.
void check(const View& view);

}  // namespace rebake
