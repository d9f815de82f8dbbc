#include "mesh_ops/rays/parallel_rays.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "mesh_ops/base/processor.h"

namespace rebake {

namespace {

// Number of triangles that can be tested at the cost of one ray.
constexpr std::size_t triangles_per_ray = 30;
// Points per block. Blocks are compact if consecutive points are close together.
constexpr std::size_t block_size = 256;
// Limit of the number of points per cell, averaged over points; beyond it single rays are faster.
constexpr double crowd = 64;

// Not inlined: GCC 12 would vectorise pairs of numbers and omit the rounding to float before they become doubles again.
[[gnu::noinline]] std::array<float, 3> in_floats(const Vec3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

const ParallelKernels& kernels() {
  static const ParallelKernels* const best = all_parallel_kernels().front();
  return *best;
}

}  // namespace

std::vector<const ParallelKernels*> all_parallel_kernels() {
  std::vector<const ParallelKernels*> kernels;
#ifdef REBAKE_WIDE_VECTORS
  if (processor_has_v3()) kernels.push_back(&parallel_kernels_v3);
#endif
  kernels.push_back(&parallel_kernels_baseline);
  return kernels;
}

// Points that one object may occlude, sorted by grid cell. Each thread reuses its buffers in later calls.
struct ParallelRays::Scratch {
  std::size_t count = 0;                            // number of candidate points
  std::vector<std::uint32_t> asked;                 // per candidate: index in `ways`
  std::array<std::vector<float>, 3> near;           // per candidate: u, v, w
  std::array<std::vector<std::uint16_t>, 2> parts;  // per candidate: part of u and of v
  std::array<std::vector<float>, 3> sorted;         // u, v, w in the order of cells
  std::vector<std::int32_t> along, marks;
  std::vector<std::uint32_t> numbers, first, counts;
  std::array<std::vector<std::uint16_t>, 2> cell_of;  // column per part of u, row per part of v

  /// The grid of the candidates; nullopt if they are too crowded.
  std::optional<PointGrid> grid(std::span<const std::int8_t> ways);

 private:
  void find_cells(std::size_t axis, std::size_t part_count, std::uint32_t cells);
};

// Chooses `cells` columns (axis 0) or rows (axis 1) with equal numbers of points.
void ParallelRays::Scratch::find_cells(std::size_t axis, std::size_t part_count, std::uint32_t cells) {
  counts.assign(part_count, 0);
  for (std::size_t k = 0; k < count; ++k) ++counts[parts[axis][k]];
  cell_of[axis].resize(part_count);
  const double cells_per_point = static_cast<double>(cells) / static_cast<double>(count);
  std::uint32_t before = 0;
  for (std::size_t part = 0; part < part_count; ++part) {
    cell_of[axis][part] =
        static_cast<std::uint16_t>(std::min(cells - 1, static_cast<std::uint32_t>(before * cells_per_point)));
    before += counts[part];
  }
}

std::optional<PointGrid> ParallelRays::Scratch::grid(std::span<const std::int8_t> ways) {
  PointGrid result;
  const std::size_t part_count = count > 32768 ? 16384 : 2048;
  std::array<float, 2> from{}, extent{}, scale{};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const float* const at = near[axis].data();
    float least = std::numeric_limits<float>::infinity(), most = -least;
    for (std::size_t k = 0; k < count; ++k) {
      least = std::min(least, at[k]);
      most = std::max(most, at[k]);
    }
    from[axis] = least;
    extent[axis] = most - least;
    const auto last = static_cast<float>(part_count - 1);
    scale[axis] = extent[axis] > 0 && last / extent[axis] < std::numeric_limits<float>::max() ? last / extent[axis] : 0;
    parts[axis].resize(count);
    for (std::size_t k = 0; k < count; ++k)
      parts[axis][k] = static_cast<std::uint16_t>(std::min(last, (at[k] - least) * scale[axis]));
  }
  // Cells are twice as high as wide, because the cells of a row are tested in one pass.
  constexpr double max_columns = 2048;
  const double aspect = extent[1] > 0 ? static_cast<double>(extent[0] / extent[1]) : max_columns * max_columns;
  const auto points = static_cast<double>(count);
  result.columns =
      static_cast<std::uint32_t>(std::clamp(std::sqrt(points * aspect), 1.0, std::min(points, max_columns)));
  result.rows = static_cast<std::uint32_t>(std::clamp(points / (2 * result.columns), 1.0, max_columns));
  find_cells(0, part_count, result.columns);
  find_cells(1, part_count, result.rows);
  const auto cell = [&](std::size_t k) { return cell_of[1][parts[1][k]] * result.columns + cell_of[0][parts[0][k]]; };
  first.assign(std::size_t{result.columns} * result.rows + 2, 0);
  for (std::size_t k = 0; k < count; ++k) ++first[cell(k) + 2];
  double pairs = 0;
  for (const std::uint32_t in_cell : first) pairs += static_cast<double>(in_cell) * in_cell;
  if (pairs > crowd * points) return std::nullopt;
  for (std::size_t c = 2; c < first.size(); ++c) first[c] += first[c - 1];
  for (std::vector<float>& column : sorted) {
    column.resize(count + PointGrid::room);
    std::fill(column.end() - PointGrid::room, column.end(), std::numeric_limits<float>::quiet_NaN());
  }
  along.assign(count + PointGrid::room, 0);
  marks.assign(count + PointGrid::room, 0);
  numbers.resize(count);
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint32_t i = asked[k], place = first[cell(k) + 1]++;
    for (std::size_t axis = 0; axis < 3; ++axis) sorted[axis][place] = near[axis][k];
    along[place] = ways[i] > 0 ? 0 : -1;
    numbers[place] = i;
  }
  result.u = sorted[0];
  result.v = sorted[1];
  result.w = sorted[2];
  result.along = along;
  result.first = first;
  result.columns_of = cell_of[0];
  result.rows_of = cell_of[1];
  result.u_from = from[0];
  result.v_from = from[1];
  result.u_scale = scale[0];
  result.v_scale = scale[1];
  return result;
}

ParallelRays::ParallelRays(const SceneRays& around, std::span<const Vec3> origins) : around_(around) {
  for (std::size_t axis = 0; axis < 3; ++axis) points_[axis].reserve(origins.size());
  for (std::size_t first = 0; first < origins.size(); first += block_size) {
    Box box;
    for (const Vec3& origin : origins.subspan(first, std::min(block_size, origins.size() - first))) {
      for (std::size_t axis = 0; axis < 3; ++axis) points_[axis].push_back(origin[static_cast<Eigen::Index>(axis)]);
      if (origin.allFinite()) box.extend(origin);
    }
    blocks_.push_back(box.isEmpty() ? SceneRays::BoundingSphere{}
                                    : SceneRays::BoundingSphere{box.center(), box.diagonal().norm() / 2});
  }
  std::map<const RayTree*, std::size_t> numbers;
  for (const SceneRays::Placed& placed : around_.placed_) {
    const auto [tree, fresh] = numbers.try_emplace(placed.tree.get(), trees_.size());
    if (fresh) trees_.push_back(std::make_unique<Triangles>());
    tree_of_.push_back(tree->second);
  }
}
ParallelRays::~ParallelRays() = default;

const ParallelRays::Triangles& ParallelRays::triangles_of(std::size_t instance) const {
  Triangles& triangles = *trees_[tree_of_[instance]];
  std::call_once(triangles.made, [&] {
    const RayTree& tree = *around_.placed_[instance].tree;
    triangles.corners = tree.corners(PointGrid::room);
    for (std::size_t set = 0; set < triangles.corners.size(); ++set) triangles.solid.push_back(tree.solid(set));
  });
  return triangles;
}

void ParallelRays::shade(const Vec3& direction, std::size_t first, std::span<const std::int8_t> ways,
                         std::span<std::uint8_t> hidden) const {
  thread_local Scratch scratch;
  for (std::size_t k = 0; k < around_.placed_.size(); ++k) shade_by(k, direction, first, ways, hidden, scratch);
}

void ParallelRays::shade_by(std::size_t instance, const Vec3& direction, std::size_t first,
                            std::span<const std::int8_t> ways, std::span<std::uint8_t> hidden, Scratch& scratch) const {
  const SceneRays::Placed& placed = around_.placed_[instance];
  const RayTree& tree = *placed.tree;
  const Affine to_frame = tree.to_frame() * placed.to_object;
  const Vec3 along = to_frame.linear() * direction;
  const double length = along.stableNorm();
  if (!(length > 0) || !std::isfinite(length) || tree.triangle_count() == 0) return;
  const Vec3 exact_w = along / length, exact_u = exact_w.unitOrthogonal(), exact_v = exact_w.cross(exact_u);
  // Points are projected on the same rounded axes as triangles.
  const LineAxes axes{in_floats(exact_u), in_floats(exact_v), in_floats(exact_w)};
  const auto rounded = [](const std::array<float, 3>& axis) -> Vec3 {
    return Eigen::Vector3f(axis[0], axis[1], axis[2]).cast<double>();
  };
  const Vec3 u = rounded(axes.u), v = rounded(axes.v), w = rounded(axes.w);
  const Box box = tree.bounds();
  const Vec3 half = tree.to_frame() * box.max();
  std::array<std::array<double, 4>, 3> rows{};
  std::array<float, 3> reach{};
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3& axis = k == 0 ? u : k == 1 ? v : w;
    const Vec3 row = to_frame.linear().transpose() * axis;
    rows[k] = {row.x(), row.y(), row.z(), axis.dot(to_frame.translation())};
    reach[k] = static_cast<float>(axis.cwiseAbs().dot(half));
  }
  scratch.asked.resize(std::max(scratch.asked.size(), ways.size()));
  for (std::vector<float>& column : scratch.near) column.resize(std::max(column.size(), ways.size()));
  std::array<std::array<float, block_size>, 3> seen;
  std::size_t count = 0;
  const std::size_t end = first + ways.size();
  for (std::size_t block = first / block_size; block * block_size < end; ++block) {
    const Vec3 way = placed.ball.middle - blocks_[block].middle;
    const double aside = (way - way.dot(direction) * direction).norm(),
                 radii = placed.ball.radius + blocks_[block].radius;
    if (aside > radii + 1e-12 * (radii + way.norm())) continue;
    const std::size_t from = std::max(first, block * block_size), to = std::min(end, (block + 1) * block_size);
    kernels().project_points({points_[0].data() + from, points_[1].data() + from, points_[2].data() + from}, to - from,
                             rows, {seen[0].data(), seen[1].data(), seen[2].data()});
    for (std::size_t k = 0; k < to - from; ++k) {
      const std::size_t i = from - first + k;
      // Branch-free compaction: every point is written to the next slot, which is kept only for a candidate.
      scratch.asked[count] = static_cast<std::uint32_t>(i);
      for (std::size_t axis = 0; axis < 3; ++axis) scratch.near[axis][count] = seen[axis][k];
      count += static_cast<std::size_t>(static_cast<int>(ways[i] != 0) & static_cast<int>(hidden[i] == 0) &
                                        static_cast<int>(std::abs(seen[0][k]) <= reach[0]) &
                                        static_cast<int>(std::abs(seen[1][k]) <= reach[1]) &
                                        static_cast<int>(static_cast<float>(ways[i]) * seen[2][k] <= reach[2]));
    }
  }
  if (count == 0) return;
  scratch.count = count;
  const std::optional<PointGrid> grid =
      count * triangles_per_ray < tree.triangle_count() ? std::nullopt : scratch.grid(ways);
  if (!grid) {
    const Vec3 in_object = placed.to_object.linear() * direction;
    for (const std::uint32_t i : std::span(scratch.asked).first(count))
      if (tree.blocked(placed.to_object * Vec3(points_[0][first + i], points_[1][first + i], points_[2][first + i]),
                       ways[i] * in_object, 0, placed.reach))
        hidden[i] = 1;
    return;
  }
  const Triangles& triangles = triangles_of(instance);
  struct PreviewRequest {
    const RayTree& tree;
    std::size_t set;
  };
  for (std::size_t set = 0; set < triangles.corners.size(); ++set) {
    const std::array<std::vector<float>, 9>& columns = triangles.corners[set];
    CornerColumns corners{};
    for (std::size_t k = 0; k < 9; ++k) corners[k] = columns[k].data();
    const PreviewRequest asked{tree, set};
    OpacityQuery opaque{&asked, nullptr};
    if (!triangles.solid[set])
      opaque.ask = [](const void* of, std::uint32_t triangle, float b1, float b2) {
        const auto& [in, number] = *static_cast<const PreviewRequest*>(of);
        return in.opaque(number, triangle, static_cast<double>(b1), static_cast<double>(b2));
      };
    kernels().mark_covered(corners, columns[0].size() - PointGrid::room, axes, *grid,
                           static_cast<float>(placed.reach * length), opaque, scratch.marks.data());
  }
  for (std::size_t place = 0; place < count; ++place)
    if (scratch.marks[place] != 0) hidden[scratch.numbers[place]] = 1;
}

}  // namespace rebake
