#pragma once

#include <cstdint>
#include <vector>

#include "mesh_ops/index/edges.h"

namespace rebake {

/// When two triangles count as joined. Lengths in object units.
struct Joining {
  /// Corners at most this far apart are one place (files repeat corners, sometimes rounded); 0: equal bit for bit.
  double tolerance = 0;
  /// Opaque texels at most this far apart join too, whatever the triangles' corners; 0: only across shared edges.
  double gap = 0;

  auto operator<=>(const Joining&) const = default;
};

/// The object's triangles in parts that hang together where they are opaque: two triangles that share an edge are
/// joined where opaque texels face each other across it (looked at in 32 places along the edge). Triangles without an
/// opaque texel are parts of their own.
struct Components {
  std::vector<std::uint32_t> part_of;       ///< a triangle's part
  std::vector<std::uint32_t> triangles_in;  ///< triangles of a part
};
Components opaque_components(const BakedObject& object, const WeldedCorners& corners, const EdgeTable& edges,
                             double gap);

}  // namespace rebake
