#include "mesh_ops/light/transport/chromaticity.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace rebake {

std::vector<std::uint32_t> chromaticity_clusters(const std::vector<Radiance>& colors) {
  constexpr double cell = 0.15, radius = 0.3;  // in natural logarithms of r / g and b / g
  std::map<std::pair<int, int>, std::vector<std::uint32_t>> cells;
  for (std::uint32_t i = 0; i < colors.size(); ++i) {
    const Radiance c = colors[i].cwiseMax(1e-4);
    cells[{static_cast<int>(std::lround(std::log(c[0] / c[1]) / cell)),
           static_cast<int>(std::lround(std::log(c[2] / c[1]) / cell))}]
        .push_back(i);
  }
  std::vector<std::uint32_t> clusters(colors.size());
  for (std::uint32_t number = 0; !cells.empty(); ++number) {
    const auto center = std::max_element(cells.begin(), cells.end(), [](const auto& a, const auto& b) {
                          return a.second.size() < b.second.size();
                        })->first;
    std::erase_if(cells, [&](const auto& entry) {
      if (std::hypot(entry.first.first - center.first, entry.first.second - center.second) * cell > radius)
        return false;
      for (const std::uint32_t i : entry.second) clusters[i] = number;
      return true;
    });
  }
  return clusters;
}

}  // namespace rebake
