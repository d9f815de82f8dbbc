#pragma once

#include <string>
#include <utility>
#include <vector>

#include "mesh_ops/deform/cages/cage_mesh.h"

namespace rebake::test {

// Cages have a diagonal of about 1.

Cage cube(int cells = 1);
/// A subdivided cube, dented: concave, in general position.
Cage dented();
/// A tetrahedron with a face split at a point at distance `thin` from an edge: needles of that height.
Cage needles(double thin);
/// A tetrahedron with an edge split at its middle, which is raised by `lift`: a cap of that height.
Cage cap(double lift);
/// A flat box.
Cage flat(double thickness);
Cage scaled(Cage cage, double scale, const Vec3& offset = Vec3(0, 0, 0));
/// Hard cages with names: cubes, a dented one, needles, caps, coincident cage vertices, two components.
std::vector<std::pair<std::string, Cage>> hard_cages();

/// Points on faces, edges and vertices, at distances of 0 to 0.1 from them on both sides, in planes of faces and on
/// extensions of edges. Every eleventh of them unless REBAKE_DEEP is set.
std::vector<Vec3> hard_points(const Cage& cage);
/// Hard points inside the cage, by its winding number from solid angles (van Oosterom), in double.
std::vector<Vec3> inside_points(const Cage& cage);

}  // namespace rebake::test
