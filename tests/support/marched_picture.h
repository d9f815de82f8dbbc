#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "render/graph/render_view.h"
#include "render/image.h"

namespace rebake::test {

/// A picture of `color(eye, direction)` for unit directions, averaged over the samples of each pixel. Colours are
/// clamped per sample. An independent reference for renderers that march rays.
template <class ColorOf>
Image marched_picture(const View& view, const ColorOf& color) {
  Image image{view.width, view.height, {}, {}};
  const Mat3 to_world = world_to_camera(view.camera).transpose();
  const double up = std::tan(view.camera.fov_degrees / 2 * std::numbers::pi / 180),
               right = up * view.width / view.height;
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x) {
      Color sum = Color::Zero();
      for (int s = 0; s < view.samples; ++s) {
        const int column = s % view.side(), row = s / view.side();
        const double u = (x + (column + 0.5) / view.side()) / view.width * 2 - 1,
                     v = 1 - (y + (row + 0.5) / view.side()) / view.height * 2;
        const Vec3 direction = (to_world * Vec3(u * right, v * up, -1)).normalized();
        sum += color(view.camera.eye, direction).cwiseMin(1) / view.samples;
      }
      for (Eigen::Index c = 0; c < 3; ++c)
        image.rgb.push_back(static_cast<std::uint8_t>(std::lround(255 * std::clamp(sum[c], 0.0, 1.0))));
    }
  return image;
}

}  // namespace rebake::test
