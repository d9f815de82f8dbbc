#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "mesh_ops/index/edges.h"

namespace rebake {

/// Criterion that joins triangles to connected components. Lengths in object units.
struct Connectivity {
  /// Corners at most this far apart are welded (files repeat corners, sometimes rounded). 0: only bit-identical
  /// corners.
  double tolerance = 0;
  /// Triangles with opaque texels at most this far apart are joined too. 0: only across shared edges.
  double gap = 0;

  auto operator<=>(const Connectivity&) const = default;
};

/// Connected components of an object's opaque surface. Triangles that share an edge are joined if opaque texels face
/// each other across it, tested at 32 places along the edge. A triangle without opaque texels is a component of its
/// own.
struct Components {
  std::vector<std::uint32_t> part_of;       ///< component number per triangle
  std::vector<std::uint32_t> triangles_in;  ///< number of triangles per component
};

/// Opacity along the half edges of a texture set's triangles, sampled at 32 places.
struct EdgeOpacity {
  std::vector<std::uint32_t> along;  ///< per half edge; bit i: opaque at place i from the corner that it starts at
};
EdgeOpacity edge_opacity(const TextureSet& set);

/// Connected components of one texture set, for bit-identical corners; numbered by their first triangles.
struct SetComponents {
  std::vector<std::uint32_t> part_of;  ///< component number per triangle
  std::uint32_t count = 0;             ///< number of components
};
SetComponents set_components(const WeldedCorners& corners, const EdgeTable& edges, const EdgeOpacity& opacity);

/// Cached indices of one texture set.
struct IndexedSet {
  std::shared_ptr<const EdgeOpacity> opacity;
  std::shared_ptr<const SetComponents> parts;
};
/// Components of an object for tolerance 0 and gap 0, from those of its sets: tests only edges that several sets share.
Components joined_components(const WeldedCorners& corners, const std::vector<IndexedSet>& sets);

/// Components of an object for any gap, and for the tolerance of `corners` and `edges`. `opacity`: per texture set.
Components opaque_components(const BakedObject& object, const WeldedCorners& corners, const EdgeTable& edges,
                             const std::vector<std::shared_ptr<const EdgeOpacity>>& opacity, double gap);

}  // namespace rebake
