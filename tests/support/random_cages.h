#pragma once

#include <random>
#include <string>
#include <vector>

#include "mesh_ops/deform/cages/cage_mesh.h"

namespace rebake::test {

/// A random cage for property tests, with a bounding diagonal between 0.1 and 3.
struct RandomCage {
  std::string name;  ///< kind and parameters, for failure messages
  Cage cage;
};

/// A tetrahedron with one sharp edge whose slope is log-uniform in [1e-4, 2]; every second one stands beside a cube ten
/// times its size, as a second component.
RandomCage random_wedge(std::mt19937_64& random);
/// A randomly rotated box, divided into 1 to 4 cells along each axis.
RandomCage random_lattice(std::mt19937_64& random);
/// A subdivided cube whose vertices lie at random distances (0.2 to 0.5) from its centre: concave, in general position.
RandomCage random_star(std::mt19937_64& random);

/// A point at a distance that is log-uniform in [1e-16, 1e-6] from a random face, edge or corner, in a random
/// direction: any, along a normal, or in the plane of an adjacent face. One point in eight lies on the feature, up to
/// rounding.
Vec3 random_near_point(const Cage& cage, std::mt19937_64& random);

}  // namespace rebake::test
