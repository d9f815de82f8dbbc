#pragma once

#include "mesh_ops/base/progress.h"
#include "mesh_ops/fill/hole_loops.h"

namespace rebake {

/// Triangles that close a hole. The first vertices are the points of the loop.
struct HolePatch {
  std::vector<Vec3> vertices;
  std::vector<Face> faces;
};

/// Largest number of points of a loop. The triangulation's time grows with their cube: 500 points take 2 s, 1000 take
/// 15 s, 1500 a minute.
inline constexpr std::size_t longest_loop = 1500;

/// Closes a hole: a triangulation of least dihedral angles and area (Liepa 2003), refined to the border's edge lengths,
/// and faired so that it continues the border's triangles smoothly (CGAL, Polygon mesh processing). Empty if the border
/// cannot be triangulated, for example because it is flat in one point. Throws Cancelled.
HolePatch hole_patch(const HoleLoop& loop, const Progress& progress = {});

}  // namespace rebake
