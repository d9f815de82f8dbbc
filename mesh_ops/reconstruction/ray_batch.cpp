#include "mesh_ops/reconstruction/ray_batch.h"

#include <tbb/parallel_for.h>

#include <cmath>

namespace rebake {

void RayBatch::find_hits(const FreeGrid& grid, const std::vector<std::uint8_t>& active, std::size_t most) {
  constexpr std::size_t rays_per_task = 32;
  const std::size_t tasks = (rays.size() + rays_per_task - 1) / rays_per_task;
  std::vector<std::vector<GridHit>> found(tasks);
  first.assign(rays.size() + 1, 0);
  tbb::parallel_for(std::size_t{0}, tasks, [&](std::size_t task) {
    for (std::size_t r = task * rays_per_task; r < std::min(rays.size(), (task + 1) * rays_per_task); ++r) {
      const std::size_t before = found[task].size();
      intersect(grid, active, rays[r].origin, rays[r].direction, most, found[task]);
      first[r + 1] = found[task].size() - before;
    }
  });
  for (std::size_t r = 0; r < rays.size(); ++r) first[r + 1] += first[r];
  hits.resize(first.back());
  points.resize(hits.size());
  along.resize(hits.size());
  lengths.assign(hits.size(), 0);
  const GridSpace& space = grid.space();
  tbb::parallel_for(std::size_t{0}, tasks, [&](std::size_t task) {
    std::copy(found[task].begin(), found[task].end(),
              hits.begin() + static_cast<std::ptrdiff_t>(first[task * rays_per_task]));
    for (std::size_t r = task * rays_per_task; r < std::min(rays.size(), (task + 1) * rays_per_task); ++r)
      for (std::size_t h = first[r]; h < first[r + 1]; ++h) {
        const Vec3 point = rays[r].origin + hits[h].t * rays[r].direction;
        Vec3 place, slope = Vec3::Zero();
        if (hits[h].cell == GridHit::no_cell) {
          place = space.box_place(static_cast<int>(hits[h].corners[0]), point);
        } else {
          place = space.field_place(space.to_cells(point));
          slope = space.field_share() / space.side() * space.cells_along(point, rays[r].direction);
        }
        for (std::size_t axis = 0; axis < 3; ++axis) {
          points[h][axis] = static_cast<float>(place[static_cast<Eigen::Index>(axis)]);
          along[h][axis] = slope[static_cast<Eigen::Index>(axis)];
        }
        if (h > first[r]) {
          double square = 0;
          for (std::size_t axis = 0; axis < 3; ++axis)
            square += std::pow(double{points[h][axis]} - double{points[first[r]][axis]}, 2);
          lengths[h] = std::sqrt(square);
        }
      }
  });
}

void RayBatch::add_position_slopes(const std::vector<FieldPoint>& point_slopes,
                                   std::vector<Vec3>& position_slopes) const {
  for (std::size_t h = 0; h < hits.size(); ++h) {
    double slope = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) slope += double{point_slopes[h][axis]} * along[h][axis];
    if (slope == 0) continue;
    for (std::size_t k = 0; k < 3; ++k)
      position_slopes[hits[h].corners[k]] += slope * hits[h].weights[k] * hits[h].motion;
  }
}

}  // namespace rebake
