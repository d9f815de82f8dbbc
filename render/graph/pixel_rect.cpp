#include "render/graph/pixel_rect.h"

#include <algorithm>
#include <cmath>

namespace rebake {

std::optional<PixelRect> projected(const Box& box, const View& view) {
  const double aspect = static_cast<double>(view.width) / view.height;
  const double nearest = view.camera.near_plane, farthest = view.camera.far_plane;
  if (box.isEmpty() || -box.min().z() < nearest || -box.max().z() > farthest) return std::nullopt;
  const PixelRect whole{0, 0, view.width, view.height};
  // Clips the box to depths [nearest, farthest] before the perspective division. Its extreme projections are at one of
  // these two depths.
  const double z0 = std::max(nearest, -box.max().z()), z1 = std::min(farthest, -box.min().z());
  double left = 1e300, right = -1e300, bottom = 1e300, top = -1e300;
  for (const double z : {z0, z1}) {
    const double half = half_height(view.camera, z);
    for (const double x : {box.min().x(), box.max().x()}) {
      left = std::min(left, x / (half * aspect));
      right = std::max(right, x / (half * aspect));
    }
    for (const double y : {box.min().y(), box.max().y()}) {
      bottom = std::min(bottom, y / half);
      top = std::max(top, y / half);
    }
  }
  if (left > 1 || right < -1 || bottom > 1 || top < -1) return std::nullopt;
  const auto pixel = [](double share, int size, int margin) {
    return static_cast<int>(std::clamp(std::floor(share * size) + margin, 0.0, static_cast<double>(size)));
  };
  // A pixel of margin absorbs rounding.
  return PixelRect{pixel((left + 1) / 2, whole.right, -1), pixel((1 - top) / 2, whole.bottom, -1),
                   pixel((right + 1) / 2, whole.right, 2), pixel((1 - bottom) / 2, whole.bottom, 2)};
}

PixelRect around(const PixelRect& rect, int pixels, const View& view) {
  if (rect.empty()) return rect;
  return {std::max(rect.left - pixels, 0), std::max(rect.top - pixels, 0), std::min(rect.right + pixels, view.width),
          std::min(rect.bottom + pixels, view.height)};
}

PixelRect join(const PixelRect& a, const PixelRect& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  return {std::min(a.left, b.left), std::min(a.top, b.top), std::max(a.right, b.right), std::max(a.bottom, b.bottom)};
}

}  // namespace rebake
