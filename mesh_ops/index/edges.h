#pragma once

#include <cstdint>
#include <vector>

#include "mesh_ops/index/weld.h"

namespace rebake {

/// Triangles per edge of a welded mesh: half edges, grouped by the pair of places (welded vertices) that they connect.
struct EdgeTable {
  std::vector<std::uint32_t> half_edges;  ///< 3 · triangle + number of the corner that it starts at
  std::vector<std::uint32_t> first_of;    ///< per edge: index of its first half edge; last: their number
};
EdgeTable edges_between(const WeldedCorners& corners);

}  // namespace rebake
