#include "mesh_ops/deform/cage_deformation.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "mesh_ops/base/polar.h"
#include "mesh_ops/deform/row_sums.h"

namespace rebake {

namespace {

std::size_t blocks_of(std::size_t points) { return (points + batch_lanes - 1) / batch_lanes; }

// The points of one block; the last is repeated where the block is not full.
std::array<Vec3, batch_lanes> block_points(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& order,
                                           std::size_t block) {
  std::array<Vec3, batch_lanes> result;
  for (std::size_t lane = 0; lane < batch_lanes; ++lane)
    result[lane] = points[order[std::min(block * batch_lanes + lane, order.size() - 1)]];
  return result;
}

// Calls visit(block, weights, gradients, outside) for every block, on all threads.
template <class Visit>
void for_blocks(const Coordinates& coordinates, const std::vector<Vec3>& points,
                const std::vector<std::uint32_t>& order, bool gradients, const Progress& progress, Visit visit) {
  const std::size_t blocks = blocks_of(order.size());
  std::atomic<std::size_t> done = 0;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks, 64), [&](const auto& range) {
    std::vector<double> weights(coordinates.rows() * batch_lanes);
    std::vector<double> slopes(gradients ? coordinates.rows() * 3 * batch_lanes : 0);
    std::array<std::uint8_t, batch_lanes> outside;
    for (std::size_t block = range.begin(); block < range.end(); ++block) {
      coordinates.weigh(block_points(points, order, block), weights.data(), gradients ? slopes.data() : nullptr,
                        outside.data());
      visit(block, weights, slopes, outside);
    }
    progress.at("cage weights", static_cast<double>(done += range.size()) / static_cast<double>(blocks));
  });
}

// What all vertices move alike, taken out of their motions where it is most of them: their weights sum to 1 but for
// rounding, which a long way would multiply.
Vec3 take_shift(std::vector<Vec3>& motions, std::size_t vertices) {
  Vec3 mean(0, 0, 0);
  for (std::size_t v = 0; v < vertices; ++v) mean += motions[v] / static_cast<double>(vertices);
  double spread = 0;
  for (std::size_t v = 0; v < vertices; ++v) spread = std::max(spread, (motions[v] - mean).stableNorm());
  if (!(2 * spread < mean.stableNorm())) return Vec3(0, 0, 0);
  for (std::size_t v = 0; v < vertices; ++v) motions[v] -= mean;
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
  const Vec3 shift = take_shift(motions, rest.vertices.size());
  const std::vector<std::uint32_t> order = curve_order(points);
  for_blocks(coordinates, points, order, jacobians, progress,
             [&](std::size_t block, const std::vector<double>& weights, const std::vector<double>& slopes,
                 const std::array<std::uint8_t, batch_lanes>& outside) {
               for (std::size_t lane = 0; lane < batch_lanes && block * batch_lanes + lane < order.size(); ++lane) {
                 const std::uint32_t point = order[block * batch_lanes + lane];
                 result.outside[point] = outside[lane];
                 if (!points[point].allFinite()) continue;
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
                         bool gradients, const Progress& progress)
    : rest_(rest), coordinates_(coordinates), points_(points), order_(curve_order(points)) {
  if (points.empty()) return;
  const std::size_t row = batch_lanes, blocks = blocks_of(points.size());
  weights_.resize(blocks * coordinates.rows() * row);
  if (gradients) gradients_.resize(blocks * coordinates.rows() * 3 * row);
  for_blocks(coordinates, points_, order_, gradients, progress,
             [&](std::size_t block, const std::vector<double>& weights, const std::vector<double>& slopes,
                 const std::array<std::uint8_t, batch_lanes>&) {
               const auto narrow = [](double a) { return static_cast<float>(a); };
               std::transform(weights.begin(), weights.end(),
                              weights_.begin() + static_cast<std::ptrdiff_t>(block * weights.size()), narrow);
               std::transform(slopes.begin(), slopes.end(),
                              gradients_.begin() + static_cast<std::ptrdiff_t>(block * slopes.size()), narrow);
             });
}

std::uint64_t CageBinding::memory() const {
  return (weights_.size() + gradients_.size()) * sizeof(float) +
         points_.size() * (sizeof(Vec3) + sizeof(std::uint32_t));
}

namespace {

// Rows that move, and how far.
struct MovingRows {
  std::vector<std::uint32_t> rows;
  std::vector<float> motions;
};
MovingRows moving_rows(const std::vector<Vec3>& motions) {
  MovingRows moving;
  for (std::uint32_t row = 0; row < motions.size(); ++row) {
    if (motions[row].isZero(0)) continue;
    moving.rows.push_back(row);
    for (int axis = 0; axis < 3; ++axis) moving.motions.push_back(static_cast<float>(motions[row][axis]));
  }
  return moving;
}

}  // namespace

void CageBinding::positions(const std::vector<Vec3>& moved, std::vector<Vec3>& out) const {
  out.resize(points_.size());
  std::vector<Vec3> motions = coordinates_.row_motions(rest_, moved);
  const Vec3 shift = take_shift(motions, rest_.vertices.size());
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
        out[point] = points_[point] +
                     (shift + Vec3(static_cast<double>(sums[lane]), static_cast<double>(sums[batch_lanes + lane]),
                                   static_cast<double>(sums[2 * batch_lanes + lane])));
      }
    }
  });
}

void CageBinding::rotations(const std::vector<Vec3>& moved, std::vector<Mat3>& out, std::size_t stride,
                            bool interpolated) const {
  if (gradients_.empty() && !points_.empty()) throw std::logic_error("bound without gradients");
  out.assign(points_.size(), Mat3::Identity());
  const MovingRows moving = moving_rows(coordinates_.row_motions(rest_, moved));
  const RowSums sum_rows = row_sums();
  const std::size_t block_size = coordinates_.rows() * 3 * batch_lanes;
  const std::size_t step = std::max<std::size_t>(stride, 1);
  const std::size_t samples = (order_.size() + step - 1) / step;
  // Whole blocks where every point is wanted; else single lanes of those that hold one.
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks_of(points_.size()), 64), [&](const auto& range) {
    for (std::size_t block = range.begin(); block < range.end(); ++block) {
      const std::size_t first = block * batch_lanes, last = std::min(first + batch_lanes, order_.size());
      const std::size_t sample = (first + step - 1) / step * step;
      if (sample >= last) continue;
      std::array<float, 9 * batch_lanes> sums;
      sum_rows(gradients_.data() + block * block_size, moving.rows.data(), moving.motions.data(), moving.rows.size(), 3,
               sums.data());
      for (std::size_t at = sample; at < last; at += step) {
        Mat3 jacobian = Mat3::Identity();
        for (int to = 0; to < 3; ++to)
          for (int axis = 0; axis < 3; ++axis)
            jacobian(to, axis) +=
                static_cast<double>(sums[static_cast<std::size_t>(to * 3 + axis) * batch_lanes + at - first]);
        out[order_[at]] = local_rotation(jacobian).rotation;
      }
    }
  });
  if (step == 1) return;
  tbb::parallel_for(std::size_t{0}, order_.size(), [&](std::size_t at) {
    if (at % step == 0) return;
    const std::size_t below = at / step * step, above = below + step < samples * step ? below + step : below;
    const Vec3& here = points_[order_[at]];
    const double to_below = (points_[order_[below]] - here).norm(), to_above = (points_[order_[above]] - here).norm();
    if (!interpolated || to_below + to_above == 0) {
      out[order_[at]] = out[order_[to_above < to_below ? above : below]];
      return;
    }
    const double share = to_below / (to_below + to_above);
    out[order_[at]] = local_rotation((1 - share) * out[order_[below]] + share * out[order_[above]]).rotation;
  });
}

}  // namespace rebake
