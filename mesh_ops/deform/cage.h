#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "mesh_ops/base/types.h"

namespace rebake {

/// A closed triangle mesh around what it deforms; faces are counter-clockwise seen from outside.
struct Cage {
  std::vector<Vec3> vertices;
  std::vector<Face> faces;

  bool operator==(const Cage&) const = default;
};

/// The box divided into n × m × k cells, as a closed surface. Corners are numbered with x running fastest, then y,
/// then z, over those on the surface. Throws Error when a count is below 1 or the surface would exceed 100,000
/// vertices.
Cage lattice_cage(const Box& box, int n, int m, int k);

/// The cage, with every component that lies in no other turned outwards, and those inside it along with it. Throws
/// Error, saying what and where, when it is not finite, has faces that name missing vertices or one vertex twice, or is
/// open, non-manifold along an edge or inconsistently oriented. Faces without area are allowed: they weigh nothing.
Cage checked_cage(Cage cage);

/// Signed volume: positive when the faces point outwards.
double volume(const Cage& cage);

/// For each vertex the lowest vertex that it hangs together with through faces.
std::vector<std::uint32_t> components(const Cage& cage);

/// Pairs of faces that cut through each other.
std::size_t self_intersections(const Cage& cage);

}  // namespace rebake
