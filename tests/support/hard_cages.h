#pragma once

#include <string>
#include <utility>
#include <vector>

#include "mesh_ops/deform/cage.h"

namespace rebake::test {

// Cages have a diagonal of about 1.

Cage cube(int cells = 1);
/// A subdivided cube, dented: concave, in general position.
Cage dented();
/// A tetrahedron with a face split at a point that lies `thin` from an edge: needles of that height.
Cage needles(double thin);
/// A tetrahedron with an edge split in two: exact for halves; and `lift` above the edge's middle otherwise.
Cage cap(double lift);
/// A flat box.
Cage flat(double thickness);
Cage scaled(Cage cage, double scale, const Vec3& offset = Vec3(0, 0, 0));
/// All of these with what else is hard: cage points that coincide, two components.
std::vector<std::pair<std::string, Cage>> hard_cages();

/// Points on each face, edge and vertex, at distances on both sides, along their planes and lines, and on corners'
/// projections.
std::vector<Vec3> hard_points(const Cage& cage);
/// Those of the hard points that are inside, by the solid angle of the cage (van Oosterom) in double.
std::vector<Vec3> inside_points(const Cage& cage);

}  // namespace rebake::test
