#include "mesh_ops/deform/cage_coordinates/cage_deformation.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "mesh_ops/deform/cage_coordinates/point_blocks.h"
#include "mesh_ops/deform/cage_coordinates/row_sums.h"

namespace rebake {

namespace {

// Subtracts the mean motion of the used vertices if none deviates from it by half its length, and returns it (else
// zero). Weights sum to 1 only up to rounding, and a long translation would amplify that error.
Vec3 subtract_mean_motion(std::vector<Vec3>& motions, const Cage& rest) {
  const std::vector<std::uint8_t> used = used_vertices(rest);
  const auto count = static_cast<double>(std::count(used.begin(), used.end(), 1));
  Vec3 mean(0, 0, 0);
  for (std::size_t v = 0; v < used.size(); ++v)
    if (used[v] != 0) mean += motions[v] / count;
  double spread = 0;
  for (std::size_t v = 0; v < used.size(); ++v)
    if (used[v] != 0) spread = std::max(spread, (motions[v] - mean).stableNorm());
  if (!(2 * spread < mean.stableNorm())) return Vec3(0, 0, 0);
  for (std::size_t v = 0; v < used.size(); ++v)
    if (used[v] != 0) motions[v] -= mean;
  return mean;
}

}  // namespace

std::vector<std::uint32_t> curve_order(const std::vector<Vec3>& points) {
  Box box;
  for (const Vec3& p : points)
    if (p.allFinite()) box.extend(p);
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys(points.size());
  const double size = box.isEmpty() ? 0 : box.sizes().maxCoeff();
  const auto spread = [](std::uint64_t v) {
    std::uint64_t result = 0;
    for (unsigned bit = 0; bit < 20; ++bit) result |= ((v >> bit) & 1U) << (3 * bit);
    return result;
  };
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
    std::uint64_t key = 0;
    if (size > 0 && points[i].allFinite())
      for (int axis = 0; axis < 3; ++axis)
        key |= spread(static_cast<std::uint64_t>((points[i][axis] - box.min()[axis]) / size * 1048575.0)) << axis;
    keys[i] = {key, static_cast<std::uint32_t>(i)};
  });
  tbb::parallel_sort(keys);
  std::vector<std::uint32_t> order(points.size());
  std::transform(keys.begin(), keys.end(), order.begin(), [](const auto& key) { return key.second; });
  return order;
}

DeformedPoints deform_points(const Coordinates& coordinates, const Cage& rest, const std::vector<Vec3>& moved,
                             const std::vector<Vec3>& points, bool jacobians, const Progress& progress) {
  DeformedPoints result;
  result.points = points;
  result.outside.assign(points.size(), 0);
  if (jacobians) result.jacobians.assign(points.size(), Mat3::Identity());
  if (points.empty()) return result;
  std::vector<Vec3> motions = coordinates.row_motions(rest, moved);
  const Vec3 shift = subtract_mean_motion(motions, rest);
  const std::vector<std::uint32_t> order = curve_order(points);
  for_blocks(coordinates, points, order, jacobians, progress,
             [&](std::size_t block, const std::vector<double>& weights, const std::vector<double>& slopes,
                 const std::array<std::uint8_t, batch_lanes>& outside) {
               for (std::size_t lane = 0; lane < batch_lanes && block * batch_lanes + lane < order.size(); ++lane) {
                 const std::uint32_t point = order[block * batch_lanes + lane];
                 result.outside[point] = outside[lane];
                 if (!points[point].allFinite() || outside[lane] != 0) continue;
                 Vec3 motion(0, 0, 0);
                 Mat3 jacobian = Mat3::Identity();
                 for (std::size_t row = 0; row < motions.size(); ++row) {
                   motion += weights[row * batch_lanes + lane] * motions[row];
                   if (!jacobians) continue;
                   const double* slope = slopes.data() + row * 3 * batch_lanes + lane;
                   jacobian += motions[row] * Vec3(slope[0], slope[batch_lanes], slope[2 * batch_lanes]).transpose();
                 }
                 result.points[point] = points[point] + (shift + motion);
                 if (jacobians) result.jacobians[point] = jacobian;
               }
             });
  return result;
}

CageBinding::CageBinding(const Coordinates& coordinates, const Cage& rest, const std::vector<Vec3>& points,
                         const Progress& progress)
    : rest_(rest), coordinates_(coordinates), points_(points), order_(curve_order(points)) {
  if (points.empty()) return;
  weights_.resize(blocks_of(points.size()) * coordinates.rows() * batch_lanes);
  outside_.resize(points.size());
  for_blocks(coordinates, points_, order_, false, progress,
             [&](std::size_t block, const std::vector<double>& weights, const std::vector<double>&,
                 const std::array<std::uint8_t, batch_lanes>& outside) {
               for (std::size_t lane = 0; lane < batch_lanes && block * batch_lanes + lane < order_.size(); ++lane)
                 outside_[order_[block * batch_lanes + lane]] = outside[lane];
               std::transform(weights.begin(), weights.end(),
                              weights_.begin() + static_cast<std::ptrdiff_t>(block * weights.size()),
                              [](double weight) { return static_cast<float>(weight); });
             });
}

std::uint64_t CageBinding::memory() const {
  return weights_.size() * sizeof(float) + points_.size() * (sizeof(Vec3) + sizeof(std::uint32_t));
}

void CageBinding::positions(const std::vector<Vec3>& moved, std::vector<Vec3>& out) const {
  out.resize(points_.size());
  std::vector<Vec3> motions = coordinates_.row_motions(rest_, moved);
  const Vec3 shift = subtract_mean_motion(motions, rest_);
  const MovingRows moving = moving_rows(motions);
  const std::size_t block_size = coordinates_.rows() * batch_lanes;
  const RowSums sum_rows = row_sums();
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks_of(points_.size()), 64), [&](const auto& range) {
    std::array<float, 3 * batch_lanes> sums;
    for (std::size_t block = range.begin(); block < range.end(); ++block) {
      sum_rows(weights_.data() + block * block_size, moving.rows.data(), moving.motions.data(), moving.rows.size(), 1,
               sums.data());
      for (std::size_t lane = 0; lane < batch_lanes && block * batch_lanes + lane < order_.size(); ++lane) {
        const std::uint32_t point = order_[block * batch_lanes + lane];
        out[point] = points_[point];
        if (outside_[point] != 0) continue;
        out[point] += (shift + Vec3(static_cast<double>(sums[lane]), static_cast<double>(sums[batch_lanes + lane]),
                                    static_cast<double>(sums[2 * batch_lanes + lane])));
      }
    }
  });
}

}  // namespace rebake
