#pragma once

#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/deform/cage.h"

namespace rebake {

/// Triangles as points in space.
struct TriangleList {
  std::vector<Vec3> points;
  std::vector<Face> faces;
};

/// A closed cage strictly around all triangles (CGAL's alpha wrap: Portaneri et al. 2022). `coarseness` is the size of
/// the smallest hollow that the wrap enters and about that of its triangles, as a share of the triangles' box diagonal
/// (0.005 … 0.5); the wrap keeps a quarter of it away from the triangles. A fine wrap may fall into several components.
/// Triangles with a corner that is not finite are left out. Throws Error when none is left.
Cage wrap(const TriangleList& triangles, double coarseness, const Progress& progress = {});

/// What makes wraps: other versions of it may make others.
const char* wrap_version();

}  // namespace rebake
