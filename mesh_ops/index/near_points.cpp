#include "mesh_ops/index/near_points.h"

#include <array>
#include <cmath>
#include <numeric>
#include <tuple>

#include "mesh_ops/index/numbering.h"

namespace rebake {

namespace {

using Cell = std::array<std::int64_t, 3>;
std::uint64_t hash_cell(const Cell& cell) {
  return mixed(static_cast<std::uint64_t>(cell[0]), static_cast<std::uint64_t>(cell[1]),
               static_cast<std::uint64_t>(cell[2]));
}
Cell cell_of(const Vec3& p, const Vec3& origin, double size) {
  const Vec3 at = (p - origin) / size;
  const auto whole = [](double x) { return static_cast<std::int64_t>(std::floor(x)); };
  return {whole(at.x()), whole(at.y()), whole(at.z())};
}

}  // namespace

void join_near(UnionFind& parts, const std::vector<Vec3>& points, const std::vector<std::uint32_t>& owner, double reach,
               const Vec3& origin) {
  // A reach below the rounding of the points is meaningless, and its cell numbers would overflow.
  double extent = 0;
  for (const Vec3& p : points) extent = std::max(extent, (p - origin).cwiseAbs().maxCoeff());
  if (!(reach > extent * 1e-15) || !std::isfinite(reach)) return;
  // Points of one cell are within reach of each other, so only neighbours need comparing.
  const double size = reach / std::sqrt(3.0);
  Numbering<Cell, decltype(&hash_cell)> cells(points.size(), &hash_cell);
  std::vector<std::uint32_t> cell(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) cell[i] = cells.number(cell_of(points[i], origin, size));
  const std::size_t count = cells.keys().size();
  std::vector<std::uint32_t> begin(count + 1, 0), order(points.size());
  for (const std::uint32_t c : cell) ++begin[c + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<std::uint32_t> at(begin.begin(), begin.end() - 1);
  for (std::uint32_t i = 0; i < points.size(); ++i) order[at[cell[i]]++] = i;
  for (std::uint32_t c = 0; c < count; ++c) {
    const std::uint32_t first = owner[order[begin[c]]];
    for (std::uint32_t i = begin[c] + 1; i < begin[c + 1]; ++i) parts.join(first, owner[order[i]]);
  }
  for (std::uint32_t c = 0; c < count; ++c) {
    const Cell& here = cells.keys()[c];
    for (std::int64_t dz = -2; dz <= 2; ++dz)
      for (std::int64_t dy = -2; dy <= 2; ++dy)
        for (std::int64_t dx = -2; dx <= 2; ++dx) {
          if (std::tie(dz, dy, dx) <= std::tuple<std::int64_t, std::int64_t, std::int64_t>(0, 0, 0)) continue;
          const std::uint32_t there = cells.find({here[0] + dx, here[1] + dy, here[2] + dz});
          if (there == decltype(cells)::empty) continue;
          if (parts.root(owner[order[begin[c]]]) == parts.root(owner[order[begin[there]]])) continue;
          bool near = false;
          for (std::uint32_t i = begin[c]; i < begin[c + 1] && !near; ++i)
            for (std::uint32_t j = begin[there]; j < begin[there + 1] && !near; ++j)
              near = (points[order[i]] - points[order[j]]).squaredNorm() <= reach * reach;
          if (near) parts.join(owner[order[begin[c]]], owner[order[begin[there]]]);
        }
  }
}

}  // namespace rebake
