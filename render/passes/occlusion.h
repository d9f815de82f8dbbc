#pragma once

#include <functional>

#include "render/passes/pass_support.h"

namespace rebake {

/// Draws all texture sets of a plan. If it runs `occlusion`, by two-pass occlusion culling: first the triangles that
/// were visible from a remembered camera nearby (all if there is none), then those that a Hi-Z pyramid of the first
/// pass does not occlude. The picture does not depend on culling. `use` binds the program for a set; `clear` clears the
/// targets.
void draw_sets(const PassInput& input, const std::function<const gl::Program&(const Draw&)>& use,
               const std::function<void()>& clear);

/// Rectangles of pixels, y up, outside which draw_sets() drew nothing in this frame: blocks of 16×16 pixels, merged
/// along rows. Without occlusion culling the single rectangle plan.covered.
std::vector<SampleRect> drawn_pixels(const PassInput& input);

}  // namespace rebake
