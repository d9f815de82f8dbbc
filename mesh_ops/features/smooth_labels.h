#pragma once

#include <cstdint>
#include <vector>

namespace rebake {

/// Two things that would rather have one label.
struct LabelBorder {
  std::uint32_t a, b;
  double cost;  ///< of having two, at least 0
};

/// A label for each thing, so that the sum of costs[thing][label] and of borders between two labels is near its least:
/// alpha expansion by CGAL, within twice the least sum (Boykov, Veksler and Zabih 2001); at least as good as each
/// thing's own best label. All things have costs of equally many labels, at least one. Deterministic.
std::vector<std::uint32_t> smooth_labels(const std::vector<std::vector<double>>& costs,
                                         const std::vector<LabelBorder>& borders);

}  // namespace rebake
