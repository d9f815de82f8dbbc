#pragma once

#include <optional>

#include "render/graph/render_view.h"

namespace rebake {

/// Pixel rectangle, y down, right and bottom excluded.
struct PixelRect {
  int left = 0, top = 0, right = 0, bottom = 0;
  bool empty() const { return left >= right || top >= bottom; }
};

/// Bounding rectangle of a camera-space box in the picture, with a margin of one pixel; nullopt if it is out of view.
std::optional<PixelRect> projected(const Box& box, const View& view);
/// The rectangle, grown by `pixels` on each side and clipped to the picture. Empty rectangles stay empty.
PixelRect around(const PixelRect& rect, int pixels, const View& view);
/// The smallest rectangle that contains both.
PixelRect join(const PixelRect& a, const PixelRect& b);

}  // namespace rebake
