#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "mesh_ops/base/types.h"

namespace rebake {

/// A closed triangle mesh around the geometry that it deforms. Faces are counter-clockwise seen from outside.
struct Cage {
  std::vector<Vec3> vertices;
  std::vector<Face> faces;

  bool operator==(const Cage&) const = default;
};

/// The surface of a box divided into n × m × k cells, with two triangles per cell side. Vertices are the lattice points
/// on the surface, numbered with x running fastest, then y, then z. Throws Error if a count is below 1 or the surface
/// would exceed 100,000 vertices.
Cage lattice_cage(const Box& box, int n, int m, int k);

/// Validates a cage and orients it: components that lie inside no other one face outwards; components inside those are
/// flipped along with them, so cavities stay cavities. Throws Error, naming the place, for non-finite vertices, for
/// vertex indices out of range or repeated in a face, and for open, non-manifold or inconsistently oriented edges.
/// Throws Error if the volume is zero. Faces without area are allowed and get no weight.
Cage checked_cage(Cage cage);

/// Per vertex: 1 if a face uses it. Others have no influence, wherever they lie.
std::vector<std::uint8_t> used_vertices(const Cage& cage);

/// Box of the vertices that faces use.
Box surface_box(const Cage& cage);

/// Signed volume: positive if the faces point outwards.
double volume(const Cage& cage);

/// Connected components: per vertex, the lowest vertex of its component.
std::vector<std::uint32_t> components(const Cage& cage);

/// Number of components that lie inside another one and face the same way. Between both, weights of mean value
/// coordinates may be arbitrarily large.
std::size_t nested_components(const Cage& cage);

/// Number of pairs of faces that intersect.
std::size_t self_intersections(const Cage& cage);

}  // namespace rebake
