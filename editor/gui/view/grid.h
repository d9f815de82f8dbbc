#pragma once

#include <vector>

#include "editor/gui/window/desk.h"
#include "render/graph/plan.h"

namespace rebake {

/// Lines on the scene's ground plane, in squares of the power of ten that fits the scene.
void add_grid(const Desk& desk, std::vector<Guides::Line>& lines);

}  // namespace rebake
