#include "mesh_ops/reconstruction/grid_space.h"

#include <cmath>
#include <limits>
#include <stdexcept>

namespace rebake {

GridSpace::GridSpace(CaptureKind kind, int side, int boxes, const Frustum& frustum)
    : kind_(kind), side_(side), boxes_(boxes), frustum_(frustum) {
  if (side < 4 || side > 512) throw std::invalid_argument("a grid has 4 to 512 cells per side");
  const double reach = kind == CaptureKind::forward ? frustum.slope : 1;
  for (int layer = 0; layer <= side; ++layer) {
    planes_.push_back(reach * (2.0 * layer / side - 1));
    depths_.push_back(std::exp(std::log(frustum_.farthest) * layer / side));
  }
}

double GridSpace::box_radius(int box) const {
  constexpr double growth = 4.1466;  // radius 16 at the last box
  return (std::exp(growth * box / std::max(1, boxes_ - 1)) + growth - 1) / growth;
}

std::optional<double> GridSpace::box_exit(int box, const Vec3& origin, const Vec3& direction) const {
  const double radius = box_radius(box);
  double t = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 2; ++axis)
    if (direction[axis] != 0)
      t = std::min(t, (std::copysign(radius, direction[axis]) - origin[axis]) / direction[axis]);
  if (!(t > 0 && t < std::numeric_limits<double>::infinity())) return std::nullopt;
  if (!(std::abs(origin.z() + t * direction.z()) < radius)) return std::nullopt;
  return t;
}

Vec3 GridSpace::field_place(const Vec3& cells) const {
  const double share = field_share();
  return (cells.array() / side_ - 0.5) * share + 0.5;
}

Vec3 GridSpace::box_place(int box, const Vec3& point) const {
  const double place = static_cast<double>(box) / std::max(1, boxes_ - 1);
  return (point * (1 + place) / box_radius(box)).array() / 4 + 0.5;
}

std::array<int, 3> GridSpace::cell_of_number(std::uint32_t cell) const {
  const auto side = static_cast<std::uint32_t>(side_);
  return {static_cast<int>(cell % side), static_cast<int>(cell / side % side), static_cast<int>(cell / (side * side))};
}

Vec3 GridSpace::to_cells(const Vec3& point) const {
  if (kind_ != CaptureKind::forward) return (point.array() + 1) * (side_ / 2.0);
  const double depth = -point.z();
  return {(point.x() / (frustum_.slope * depth) + 1) * (side_ / 2.0),
          (point.y() / (frustum_.slope * depth) + 1) * (side_ / 2.0),
          std::log(depth) / std::log(frustum_.farthest) * side_};
}

Vec3 GridSpace::from_cells(const Vec3& cells) const {
  const Vec3 even = cells.array() * (2.0 / side_) - 1;
  if (kind_ != CaptureKind::forward) return even;
  const double depth = std::exp(std::log(frustum_.farthest) * cells.z() / side_);
  return {frustum_.slope * even.x() * depth, frustum_.slope * even.y() * depth, -depth};
}

Mat3 GridSpace::from_cells_slopes(const Vec3& cells) const {
  const double step = 2.0 / side_;
  if (kind_ != CaptureKind::forward) return step * Mat3::Identity();
  const Vec3 point = from_cells(cells);
  const double depth = -point.z(), grows = std::log(frustum_.farthest) / side_;
  Mat3 slopes = Mat3::Zero();
  slopes(0, 0) = slopes(1, 1) = frustum_.slope * depth * step;
  slopes.col(2) = grows * point;
  return slopes;
}

Vec3 GridSpace::cells_along(const Vec3& point, const Vec3& direction) const {
  if (kind_ != CaptureKind::forward) return direction * (side_ / 2.0);
  const double depth = -point.z(), grows = -direction.z(), scale = side_ / (2 * frustum_.slope * depth);
  return {scale * (direction.x() - point.x() / depth * grows), scale * (direction.y() - point.y() / depth * grows),
          grows / depth / std::log(frustum_.farthest) * side_};
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
    begin = nearest() / direction.norm();
    for (int axis = 0; axis < 3; ++axis) {
      clip(1 - origin[axis], -direction[axis]);
      clip(1 + origin[axis], direction[axis]);
    }
  } else {
    const double depth = -origin.z(), grows = -direction.z();
    clip(depth - 1, grows);
    clip(depths_.back() - depth, -grows);
    for (int axis = 0; axis < 2; ++axis) {
      clip(frustum_.slope * depth - origin[axis], frustum_.slope * grows - direction[axis]);
      clip(frustum_.slope * depth + origin[axis], frustum_.slope * grows + direction[axis]);
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
