#pragma once

#include <cstdint>
#include <vector>

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
};

/// `iterations` of local and global steps; more come nearer to the minimum. Throws Error when nothing is held, and when
/// the mesh cannot be solved for.
HandledCage as_rigid_as_possible(const Cage& cage, const std::vector<HandledVertex>& held, int iterations);

}  // namespace rebake
