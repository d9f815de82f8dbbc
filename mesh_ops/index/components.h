#pragma once

#include <cstdint>
#include <memory>
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

/// For each half edge of a set's triangles which of 32 places along it show an opaque texel: bit i the i-th, from the
/// corner it starts at.
struct EdgeOpacity {
  std::vector<std::uint32_t> along;
};
EdgeOpacity edge_opacity(const TextureSet& set);

/// One set's triangles in parts, whose corners are equal bit for bit. Numbered by their first triangles.
struct SetParts {
  std::vector<std::uint32_t> part_of;
  std::uint32_t count = 0;
};
SetParts set_parts(const WeldedCorners& corners, const EdgeTable& edges, const EdgeOpacity& opacity);

/// What a set is known by.
struct KnownSet {
  std::shared_ptr<const EdgeOpacity> opacity;
  std::shared_ptr<const SetParts> parts;
};
/// The components of an object whose corners are equal bit for bit, without a gap: only edges that sets share are
/// looked at again.
Components joined_components(const WeldedCorners& corners, const std::vector<KnownSet>& sets);

/// The same with any tolerance and gap. `opacity`: each set's.
Components opaque_components(const BakedObject& object, const WeldedCorners& corners, const EdgeTable& edges,
                             const std::vector<std::shared_ptr<const EdgeOpacity>>& opacity, double gap);

}  // namespace rebake
