#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "mesh_ops/scene/scene.h"

namespace rebake {

/// Difference of two scenes, for titles of steps. Counts are sums over the nodes that changed.
struct SceneChange {
  std::vector<std::string> names;          ///< of nodes whose triangles or selection changed, and of removed nodes
  std::vector<std::string> with_selected;  ///< names of changed nodes with selected triangles afterwards
  std::size_t selected_before = 0, selected_after = 0;
  std::size_t triangles_before = 0, triangles_after = 0;
  std::size_t moved = 0;                ///< triangles of which a corner moved or rotated, if none was added or removed
  std::vector<std::string> with_moved;  ///< names of nodes with such triangles
  std::vector<std::string> added;       ///< names of new nodes that are not inside other new ones
};

/// Whether two nodes have the same triangles selected.
bool same_selection(const Node& a, const Node& b);

SceneChange change_between(const Scene& before, const Scene& after);

/// "1 triangle", "12 triangles".
std::string triangles_text(std::size_t triangles);
/// "ficus", "ficus and kettle", "3 objects".
std::string listed(const std::vector<std::string>& names);

}  // namespace rebake
