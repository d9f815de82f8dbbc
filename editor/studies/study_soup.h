#pragma once

#include <vector>

#include "mesh_ops/deform/cages/wrap.h"
#include "mesh_ops/scene/scene.h"

namespace rebake {

/// Test geometry of the deformation studies: all visible objects of a scene as one triangle soup.
struct StudySoup {
  TriangleList opaque;       ///< triangles with an opaque texel, world space
  std::vector<Vec3> places;  ///< distinct positions of their corners
  double diagonal;           ///< of their bounding box, scene units
};
/// Throws Error if nothing visible is opaque.
StudySoup study_soup(const Scene& scene);

/// Vertices of the cage twisted by 1 radian, from bottom to top, about the vertical axis through its centre: a
/// deformation that is rigid nowhere.
std::vector<Vec3> twisted(const Cage& cage);

}  // namespace rebake
