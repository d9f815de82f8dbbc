#pragma once

#include "mesh_ops/registration/similarity.h"
#include "mesh_ops/scene/scene.h"

namespace rebake::test {

/// Two captures of one procedural landscape with pillars, of which they share a strip. Each is triangulated on its own.
struct OverlappingCaptures {
  Scene scene;               ///< nodes "moved" and "fixed"
  Similarity truth;          ///< takes "moved" to its true place beside "fixed"
  double diagonal = 0;       ///< of "fixed"
  std::vector<Vec3> points;  ///< landmarks of the strip as "moved" has them
  std::vector<Vec3> onto;    ///< the same of "fixed"
};

/// `overlap`: share of each capture that the other has, too. `outliers`: share of small floating triangles, by area.
/// `truth`: where "moved" belongs; it is generated at its inverse.
OverlappingCaptures overlapping_captures(double overlap, double outliers, const Similarity& truth, unsigned seed = 1);

/// Largest error of a motion over the moved capture, as a share of the diagonal.
double place_error(const OverlappingCaptures& captures, const Affine& motion);
/// Angle between the rotations of a motion and of the truth, in degrees.
double rotation_error(const OverlappingCaptures& captures, const Affine& motion);

}  // namespace rebake::test
