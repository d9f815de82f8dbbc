#pragma once

#include <optional>

#include "render/graph/view.h"

namespace rebake {

/// Pixel rectangle, y down, right and bottom excluded.
struct PixelRect {
  int left = 0, top = 0, right = 0, bottom = 0;
  bool empty() const { return left >= right || top >= bottom; }
};

/// Where a camera-space box falls in the picture, with a pixel around it: nothing when it is out of view.
std::optional<PixelRect> projected(const Box& box, const View& view);
/// With so many pixels of the picture around it.
PixelRect around(const PixelRect& rect, int pixels, const View& view);
/// What holds both.
PixelRect join(const PixelRect& a, const PixelRect& b);

}  // namespace rebake
