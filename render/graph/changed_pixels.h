#pragma once

#include "render/graph/plan.h"

namespace rebake {

/// Radius, in pixels, within which a pixel of the mask affects tints and outlines (selection.frag, outline.frag).
inline constexpr int mask_radius = 4;

/// The part of a frame that may differ from the frame before it, if it is worthwhile to draw only that part.
struct ChangedPixels {
  std::optional<PixelRect> pixels;  ///< nullopt: draw the whole frame; an empty rectangle: no pixel changed
  std::string why;                  ///< reason, for the plan
};

/// Compares the plans of two consecutive frames. `before`: null if there is none; `now`: without its passes yet.
/// Returns pixels only if nothing but texels changed. Conservative: may include unchanged pixels.
ChangedPixels changed_pixels(const FramePlan* before, const FramePlan& now);

}  // namespace rebake
