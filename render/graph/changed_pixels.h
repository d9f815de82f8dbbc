#pragma once

#include "render/graph/plan.h"

namespace rebake {

/// So many pixels around what is marked its marks depend on.
inline constexpr int mark_pixels = 4;

/// The pixels in which a frame may differ from the one before it, where it is enough to draw those.
struct ChangedPixels {
  std::optional<PixelRect> pixels;  ///< nothing where all are to be drawn; may be empty
  std::string why;
};

/// `now` without its passes. Both differ in texels at most: other differences are drawn whole. Errs on the side of more
/// pixels.
ChangedPixels changed_pixels(const FramePlan* before, const FramePlan& now);

}  // namespace rebake
