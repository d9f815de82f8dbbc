#include "editor/studies/gradient_binding.h"

#include "mesh_ops/base/polar.h"
#include "mesh_ops/deform/cage_coordinates/cage_deformation.h"
#include "mesh_ops/deform/cage_coordinates/point_blocks.h"
#include "mesh_ops/deform/cage_coordinates/row_sums.h"

namespace rebake {

GradientBinding::GradientBinding(const Coordinates& coordinates, const Cage& rest, const std::vector<Vec3>& points)
    : rest_(rest), coordinates_(coordinates), points_(points), order_(curve_order(points)) {
  if (points.empty()) return;
  gradients_.resize(blocks_of(points.size()) * coordinates.rows() * 3 * batch_lanes);
  for_blocks(coordinates, points_, order_, true, {},
             [&](std::size_t block, const std::vector<double>&, const std::vector<double>& slopes,
                 const std::array<std::uint8_t, batch_lanes>&) {
               std::transform(slopes.begin(), slopes.end(),
                              gradients_.begin() + static_cast<std::ptrdiff_t>(block * slopes.size()),
                              [](double slope) { return static_cast<float>(slope); });
             });
}

void GradientBinding::rotations(const std::vector<Vec3>& moved, std::vector<Mat3>& out, std::size_t stride,
                                bool interpolated) const {
  out.assign(points_.size(), Mat3::Identity());
  const MovingRows moving = moving_rows(coordinates_.row_motions(rest_, moved));
  const RowSums sum_rows = row_sums();
  const std::size_t block_size = coordinates_.rows() * 3 * batch_lanes;
  const std::size_t step = std::max<std::size_t>(stride, 1);
  const std::size_t samples = (order_.size() + step - 1) / step;
  // Computes whole blocks, and reads the lanes of the sample points. Blocks without a sample point are skipped.
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
