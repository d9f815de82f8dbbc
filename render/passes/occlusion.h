#pragma once

#include <functional>

#include "render/passes/pass_support.h"

namespace rebake {

/// Draws all sets of a plan in their order, with the same result as if all their triangles were drawn. `use` makes
/// ready to draw a set and returns the program; `clear` empties the targets. Where the plan runs `occlusion`: what
/// showed when it was last looked from near by (all, where it was not) first, then what its depth does not hide.
void draw_sets(const PassInput& input, const std::function<const gl::Program&(const Draw&)>& use,
               const std::function<void()>& clear);

/// Pixels, y up, outside which draw_sets drew nothing in this frame; one rectangle, the plan's, where that was not
/// worked out.
std::vector<SampleRect> drawn_pixels(const PassInput& input);

}  // namespace rebake
