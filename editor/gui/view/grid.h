#pragma once

#include <vector>

#include "mesh_ops/scene/scene.h"
#include "render/graph/guides.h"

namespace rebake {

/// Appends a grid of 20 × 20 squares on a ground plane, around the scene. A square's side is the largest
/// power of ten that is at most the scene's diagonal. The ground's x axis is red, its z axis blue.
void add_grid(const Scene& scene, const Ground& ground, std::vector<Guides::Line>& lines);

}  // namespace rebake
