#pragma once

#include <cstdint>
#include <vector>

#include "mesh_ops/index/weld.h"

namespace rebake {

/// Which triangles share an edge: half edges (3 · triangle + corner it starts at), those between the same two places
/// side by side.
struct EdgeTable {
  std::vector<std::uint32_t> half_edges;
  std::vector<std::uint32_t> first_of;  ///< where each edge's begin; one more at the end
};
EdgeTable edges_between(const WeldedCorners& corners);

}  // namespace rebake
