#pragma once

#include <cstdint>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/deform/cages/cage_mesh.h"

namespace rebake {

/// A constrained vertex of a cage and its target position. Other vertices are free.
struct ConstrainedVertex {
  std::uint32_t vertex;
  Vec3 place;
};

/// Result of an as-rigid-as-possible deformation (Sorkine, Alexa 2007; implemented by CGAL).
struct ConstrainedCage {
  std::vector<Vec3> vertices;
  std::size_t free_components = 0;  ///< connected components without a constrained vertex; they do not move
  int iterations = 0;               ///< number of iterations done
  double residual = 0;              ///< largest motion of a vertex in the last iteration, over the cage's diagonal
  double energy = 0;                ///< remaining energy for a cage of diagonal 1; 0 if the motion is rigid
};

/// Iterations stop when ConstrainedCage::residual reaches this.
inline constexpr double handles_residual = 1e-6;

/// Deforms a cage with some vertices constrained. Starts from the rigid motion that best fits the constrained vertices
/// of each component (Kabsch 1976). If they moved rigidly, by whatever angle, that is the result; otherwise up to
/// `iterations` local and global steps follow. Components whose constrained vertices did not move keep their bits.
/// Throws Error if no vertex of a face is constrained, two parts of the cage meet in a single vertex, or the system
/// cannot be solved.
ConstrainedCage as_rigid_as_possible(const Cage& cage, const std::vector<ConstrainedVertex>& held, int iterations,
                                     const Progress& progress = {});

}  // namespace rebake
