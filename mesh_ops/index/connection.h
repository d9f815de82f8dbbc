#pragma once

#include <cstdint>
#include <vector>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// When two triangles count as joined. Lengths in object units.
struct Joining {
  /// Corners at most this far apart are one place (files repeat corners, sometimes rounded); 0: equal bit for bit.
  double tolerance = 0;
  /// Opaque texels at most this far apart join too, whatever the triangles' corners; 0: only across shared edges.
  double gap = 0;

  auto operator<=>(const Joining&) const = default;
};

/// Corners of an object's triangles, welded: three place numbers a triangle.
struct WeldedCorners {
  std::vector<std::uint32_t> places;  ///< 3 a triangle
  std::uint32_t place_count = 0;
};
WeldedCorners weld(const BakedObject& object, double tolerance);

/// Which triangles share an edge: half edges (3 · triangle + corner it starts at), those between the same two places
/// side by side.
struct EdgeTable {
  std::vector<std::uint32_t> half_edges;
  std::vector<std::uint32_t> first_of;  ///< where each edge's begin; one more at the end
};
EdgeTable edges_between(const WeldedCorners& corners);

/// The object's triangles in parts that hang together where they are opaque: two triangles that share an edge are
/// joined where opaque texels face each other across it (looked at in 32 places along the edge). Triangles without an
/// opaque texel are parts of their own.
struct Components {
  std::vector<std::uint32_t> part_of;       ///< a triangle's part
  std::vector<std::uint32_t> triangles_in;  ///< triangles of a part
};
Components opaque_components(const BakedObject& object, const WeldedCorners& corners, const EdgeTable& edges,
                             double gap);

/// The selection and the triangles that share a place with it.
TriangleSet grown(const WeldedCorners& corners, const TriangleSet& selection);
/// The selection without the triangles that share a place with others.
TriangleSet shrunk(const WeldedCorners& corners, const TriangleSet& selection);
/// The selection and the islands inside it: unselected triangles, joined through shared edges, that border selected
/// ones and are fewer than `largest`.
TriangleSet filled(const EdgeTable& edges, const TriangleSet& selection, std::size_t largest);

}  // namespace rebake
