#pragma once

#include <vector>

#include "mesh_ops/deform/wrap.h"
#include "mesh_ops/scene/scene.h"

namespace rebake {

/// What studies of deformation work on: everything visible.
struct StudySoup {
  TriangleList opaque;       ///< triangles that show something, in world space
  std::vector<Vec3> places;  ///< their corners, each place once
  double diagonal;           ///< of their box
};
StudySoup study_soup(const Scene& scene);

/// The cage twisted by a radian about its middle's upright, from its foot to its top: far from rigid everywhere.
std::vector<Vec3> twisted(const Cage& cage);

}  // namespace rebake
