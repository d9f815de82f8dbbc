#include "mesh_ops/index/edges.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>
#include <utility>

namespace rebake {

EdgeTable edges_between(const WeldedCorners& corners) {
  const std::vector<std::uint32_t>& places = corners.places;
  const auto end_of = [&](std::size_t half_edge) { return places[half_edge - half_edge % 3 + (half_edge + 1) % 3]; };
  const auto low = [&](std::size_t e) { return std::min(places[e], end_of(e)); };
  const auto high = [&](std::size_t e) { return std::max(places[e], end_of(e)); };
  // Counting sort by the lower place; the few half edges per place are then sorted by the higher one.
  std::vector<std::uint32_t> begin(corners.place_count + 1U, 0);
  for (std::size_t e = 0; e < places.size(); ++e) ++begin[low(e) + 1U];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  EdgeTable table;
  table.half_edges.resize(places.size());
  std::vector<std::uint32_t> at(begin.begin(), begin.end() - 1);
  for (std::uint32_t e = 0; e < places.size(); ++e) table.half_edges[at[low(e)]++] = e;
  tbb::parallel_for(std::size_t{0}, static_cast<std::size_t>(corners.place_count), [&](std::size_t place) {
    std::sort(table.half_edges.begin() + begin[place], table.half_edges.begin() + begin[place + 1],
              [&](std::uint32_t a, std::uint32_t b) { return std::pair(high(a), a) < std::pair(high(b), b); });
  });
  for (std::uint32_t i = 0; i < places.size(); ++i) {
    const std::uint32_t e = table.half_edges[i];
    if (i == 0 || low(e) != low(table.half_edges[i - 1]) || high(e) != high(table.half_edges[i - 1]))
      table.first_of.push_back(i);
  }
  table.first_of.push_back(static_cast<std::uint32_t>(places.size()));
  return table;
}

}  // namespace rebake
