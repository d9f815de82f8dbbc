#pragma once

#include <vector>

#include "editor/gui/window/desk.h"
#include "render/graph/plan.h"

namespace rebake {

/// Lines on the ground below the scene, in squares of the power of ten that fits it.
void add_grid(const Desk& desk, std::vector<Guides::Line>& lines);

}  // namespace rebake
