#pragma once

#include <vector>

#include "editor/gui/state/editor_context.h"
#include "render/graph/plan.h"

namespace rebake {

/// Appends a grid of 20 × 20 squares on the scene's ground plane, around the scene. A square's side is the largest
/// power of ten that is at most the scene's diagonal. The ground's x axis is red, its z axis blue.
void add_grid(const EditorContext& editor, std::vector<Guides::Line>& lines);

}  // namespace rebake
