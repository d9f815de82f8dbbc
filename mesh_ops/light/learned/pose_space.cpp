#include "mesh_ops/light/learned/pose_space.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rebake {

std::vector<std::uint32_t> PoseSpace::probes_of(const std::vector<Vec3>& rest, std::size_t probes) {
  std::vector<std::uint32_t> chosen;
  if (rest.empty()) return chosen;
  std::vector<double> distance(rest.size(), std::numeric_limits<double>::infinity());
  std::uint32_t next = 0;
  while (chosen.size() < std::min(probes, rest.size())) {
    chosen.push_back(next);
    for (std::size_t i = 0; i < rest.size(); ++i)
      distance[i] = std::min(distance[i], (rest[i] - rest[chosen.back()]).squaredNorm());
    const auto farthest = std::max_element(distance.begin(), distance.end());
    if (!(*farthest > 0)) break;
    next = static_cast<std::uint32_t>(farthest - distance.begin());
  }
  return chosen;
}

PoseSpace::PoseSpace(std::vector<Vec3> at_rest, const std::vector<std::vector<Vec3>>& poses)
    : rest(std::move(at_rest)) {
  Box box;
  for (const Vec3& p : rest) box.extend(p);
  if (!box.isEmpty() && box.diagonal().norm() > 0) size = box.diagonal().norm();
  const auto count = static_cast<Eigen::Index>(poses.size());
  Eigen::MatrixXd rows(count, static_cast<Eigen::Index>(3 * rest.size()));
  for (Eigen::Index k = 0; k < count; ++k) rows.row(k) = displacement(poses[static_cast<std::size_t>(k)]);
  mean = count > 0 ? Eigen::VectorXd(rows.colwise().mean()) : Eigen::VectorXd::Zero(rows.cols());
  rows.rowwise() -= mean.transpose();
  // Axes below a thousandth of the first are rounding errors.
  constexpr double least = 1e-3;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(rows, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::VectorXd& values = svd.singularValues();
  Eigen::Index kept = 0;
  while (kept < values.size() && values[kept] > 0 && values[kept] > least * values[0]) ++kept;
  deviations = values.head(kept) / std::sqrt(std::max<double>(1, static_cast<double>(count)));
  axes = deviations.cwiseInverse().asDiagonal() * svd.matrixV().leftCols(kept).transpose();
  farthest = largest = 0;
  for (Eigen::Index k = 0; k < count; ++k) {
    farthest = std::max(farthest, (axes * rows.row(k).transpose()).norm());
    largest = std::max(largest, rows.row(k).norm());
  }
}

Eigen::VectorXd PoseSpace::displacement(const std::vector<Vec3>& probes) const {
  Eigen::VectorXd x(static_cast<Eigen::Index>(3 * rest.size()));
  for (std::size_t i = 0; i < rest.size(); ++i)
    x.segment<3>(static_cast<Eigen::Index>(3 * i)) = (probes[i] - rest[i]) / size;
  return x;
}

PoseSpace::Place PoseSpace::place(const std::vector<Vec3>& probes) const {
  const Eigen::VectorXd away = displacement(probes) - mean;
  Place result{axes * away, 0};
  const Eigen::VectorXd left = away - axes.transpose() * deviations.cwiseAbs2().asDiagonal() * result.coordinates;
  constexpr double over = 0.05;
  const double infinity = std::numeric_limits<double>::infinity();
  const auto share = [&](double value, double most) { return value == 0 ? 0 : most > 0 ? value / most : infinity; };
  result.range = std::max(share(result.coordinates.norm(), farthest), share(left.norm(), over * largest));
  if (!away.allFinite()) result.range = infinity;
  return result;
}

}  // namespace rebake
