#pragma once

#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/deform/cages/cage_mesh.h"

namespace rebake {

/// Triangles as vertex positions and vertex indices.
struct TriangleList {
  std::vector<Vec3> points;
  std::vector<Face> faces;
};

/// A closed cage strictly around all triangles (CGAL's alpha wrap: Portaneri et al. 2022). `coarseness` is relative to
/// the diagonal of the triangles' box, 0.005 … 0.5. It is the size of the smallest cavity that the wrap enters, and
/// about the size of its triangles; the distance from the triangles is a quarter of it. A fine wrap may have several
/// components. Triangles without area or with a corner that is not finite are ignored. Throws FieldError for a
/// coarseness out of range, and Error if no triangle is left.
Cage wrap(const TriangleList& triangles, double coarseness, const Progress& progress = {});

/// Identifies the version of wrap() and CGAL, as part of cache keys: other versions may give other wraps.
const char* wrap_version();

}  // namespace rebake
