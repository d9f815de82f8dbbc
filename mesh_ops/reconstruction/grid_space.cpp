#include "mesh_ops/reconstruction/grid_space.h"

#include <cmath>
#include <limits>
#include <stdexcept>

namespace rebake {

namespace {

constexpr double slope_of_frustum = 0.875;  // 0.7 · 1.25
const double log_of_farthest = std::log(25.0);

}  // namespace

GridSpace::GridSpace(CaptureKind kind, int side) : kind_(kind), side_(side) {
  if (side < 4 || side > 512) throw std::invalid_argument("a grid has 4 to 512 cells per side");
  const double reach = kind == CaptureKind::forward ? slope_of_frustum : 1;
  for (int layer = 0; layer <= side; ++layer) {
    planes_.push_back(reach * (2.0 * layer / side - 1));
    depths_.push_back(std::exp(log_of_farthest * layer / side));
  }
}

std::array<int, 3> GridSpace::cell_of_number(std::uint32_t cell) const {
  const auto side = static_cast<std::uint32_t>(side_);
  return {static_cast<int>(cell % side), static_cast<int>(cell / side % side), static_cast<int>(cell / (side * side))};
}

Vec3 GridSpace::to_cells(const Vec3& point) const {
  if (kind_ != CaptureKind::forward) return (point.array() + 1) * (side_ / 2.0);
  const double depth = -point.z();
  return {(point.x() / (slope_of_frustum * depth) + 1) * (side_ / 2.0),
          (point.y() / (slope_of_frustum * depth) + 1) * (side_ / 2.0), std::log(depth) / log_of_farthest * side_};
}

Vec3 GridSpace::from_cells(const Vec3& cells) const {
  const Vec3 even = cells.array() * (2.0 / side_) - 1;
  if (kind_ != CaptureKind::forward) return even;
  const double depth = std::exp(log_of_farthest * cells.z() / side_);
  return {slope_of_frustum * even.x() * depth, slope_of_frustum * even.y() * depth, -depth};
}

Mat3 GridSpace::from_cells_slopes(const Vec3& cells) const {
  const double step = 2.0 / side_;
  if (kind_ != CaptureKind::forward) return step * Mat3::Identity();
  const Vec3 point = from_cells(cells);
  const double depth = -point.z(), grows = log_of_farthest / side_;
  Mat3 slopes = Mat3::Zero();
  slopes(0, 0) = slopes(1, 1) = slope_of_frustum * depth * step;
  slopes.col(2) = grows * point;
  return slopes;
}

Vec3 GridSpace::cells_along(const Vec3& point, const Vec3& direction) const {
  if (kind_ != CaptureKind::forward) return direction * (side_ / 2.0);
  const double depth = -point.z(), grows = -direction.z(), scale = side_ / (2 * slope_of_frustum * depth);
  return {scale * (direction.x() - point.x() / depth * grows), scale * (direction.y() - point.y() / depth * grows),
          grows / depth / log_of_farthest * side_};
}

std::optional<std::pair<double, double>> GridSpace::range_of(const Vec3& origin, const Vec3& direction) const {
  double begin = 0, end = std::numeric_limits<double>::infinity();
  // Keeps the part with a + t · b ≥ 0.
  const auto clip = [&](double a, double b) {
    if (b > 0)
      begin = std::max(begin, -a / b);
    else if (b < 0)
      end = std::min(end, -a / b);
    else if (a < 0)
      end = -1;
  };
  if (kind_ != CaptureKind::forward) {
    for (int axis = 0; axis < 3; ++axis) {
      clip(1 - origin[axis], -direction[axis]);
      clip(1 + origin[axis], direction[axis]);
    }
  } else {
    const double depth = -origin.z(), grows = -direction.z();
    clip(depth - 1, grows);
    clip(depths_.back() - depth, -grows);
    for (int axis = 0; axis < 2; ++axis) {
      clip(slope_of_frustum * depth - origin[axis], slope_of_frustum * grows - direction[axis]);
      clip(slope_of_frustum * depth + origin[axis], slope_of_frustum * grows + direction[axis]);
    }
  }
  if (!(begin < end)) return std::nullopt;
  return std::pair(begin, end);
}

double GridSpace::crossing(int axis, int layer, const Vec3& origin, const Vec3& direction) const {
  const auto at = static_cast<std::size_t>(layer);
  if (kind_ != CaptureKind::forward) return (planes_[at] - origin[axis]) / direction[axis];
  if (axis == 2) return (-depths_[at] - origin.z()) / direction.z();
  const double t = -(origin[axis] + planes_[at] * origin.z()) / (direction[axis] + planes_[at] * direction.z());
  // The ray's direction from the eye tends to a limit; it crosses planes beyond that only behind the eye.
  return origin.z() + t * direction.z() < 0 ? t : std::numeric_limits<double>::infinity();
}

int GridSpace::trend(int axis, const Vec3& origin, const Vec3& direction) const {
  double grows = direction[axis];
  if (kind_ == CaptureKind::forward)
    grows = axis == 2 ? -direction.z() : origin[axis] * direction.z() - direction[axis] * origin.z();
  return grows > 0 ? 1 : grows < 0 ? -1 : 0;
}

}  // namespace rebake
