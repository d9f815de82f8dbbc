#pragma once

#include <vector>

#include "mesh_ops/deform/cage.h"

namespace rebake::test {

// Cages have a diagonal of about 1.

Cage cube(int cells = 1);
/// A subdivided cube, dented: concave, in general position.
Cage dented();

/// Points on each face, edge and vertex, at distances on both sides, along their planes and lines, and on corners'
/// projections.
std::vector<Vec3> hard_points(const Cage& cage);
/// Those of the hard points that are inside, by the solid angle of the cage (van Oosterom) in double.
std::vector<Vec3> inside_points(const Cage& cage);

}  // namespace rebake::test
