#pragma once

#include <cstdint>
#include <vector>

namespace rebake {

/// An edge between two nodes that prefer equal labels.
struct LabelBorder {
  std::uint32_t a, b;
  double cost;  ///< cost of different labels, ≥ 0
};

/// Assigns a label per node that nearly minimises the sum of costs[node][label] and the costs of edges with different
/// labels: alpha expansion by CGAL, within a factor of two of the minimum (Boykov, Veksler and Zabih 2001), and at
/// least as good as each node's own best label. All nodes have costs for the same number of labels, at least one.
/// Deterministic.
std::vector<std::uint32_t> smooth_labels(const std::vector<std::vector<double>>& costs,
                                         const std::vector<LabelBorder>& borders);

}  // namespace rebake
