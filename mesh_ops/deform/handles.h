#pragma once

#include <cstdint>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/deform/cage.h"

namespace rebake {

/// Where a cage's vertices are held: those without a place are free.
struct HandledVertex {
  std::uint32_t vertex;
  Vec3 place;
};

/// The cage deformed as rigidly as possible (Sorkine, Alexa 2007; CGAL) with some of its vertices held in place.
struct HandledCage {
  std::vector<Vec3> vertices;
  std::size_t free_components = 0;  ///< no vertex held: they stay where they are
  int iterations = 0;               ///< that were done
  double residual = 0;              ///< the farthest that a vertex went in the last one, in diagonals of the cage
  double energy = 0;                ///< what is left of it: 0 where the motion is rigid; of a cage of diagonal 1
};

/// Iterations stop at this residual.
inline constexpr double handles_residual = 1e-6;

/// Starts from the rigid motion that fits the held vertices of each component best (Kabsch 1976), which is the answer
/// where they moved rigidly, whatever the angle; then up to `iterations` local and global steps. What is held where it
/// was moves nothing, bit for bit. Throws Error when nothing is held, and when the mesh cannot be solved for.
HandledCage as_rigid_as_possible(const Cage& cage, const std::vector<HandledVertex>& held, int iterations,
                                 const Progress& progress = {});

}  // namespace rebake
