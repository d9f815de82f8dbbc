#include "render/passes/screen_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rebake {

namespace {

// Rounding error of a float, relative, and the maximum number of such errors in two transforms by floats, the driver's
// and ours. Each has three products, three sums, and the rounding of the matrix and of the position.
constexpr double float_rounding = 1.0 / (1 << 24);
constexpr double roundings = 16;
// Displacement of a corner in samples when it is snapped to the grid of 1/256, with a margin.
constexpr double snapping = 1.0 / 128;
// Height of a triangle in samples below which its depth is rounding noise.
constexpr double min_reliable_height = 1.0 / 32;

}  // namespace

ScreenBounder::ScreenBounder(const Eigen::Matrix4d& to_clip, const Box& bounds, const Vec2& nearness_of_depth,
                             int width, int height, const SampleRect& rect)
    : to_clip_(to_clip),
      factor_(nearness_of_depth.x()),
      offset_(nearness_of_depth.y()),
      half_width_(width / 2.0),
      half_height_(height / 2.0),
      rect_(rect) {
  const Vec3 half = bounds.isEmpty() ? Vec3(0, 0, 0) : Vec3(bounds.sizes() / 2);
  const Vec3 center = bounds.isEmpty() ? Vec3(0, 0, 0) : Vec3(bounds.center());
  const Eigen::Vector4d shift = to_clip * center.homogeneous();
  Eigen::Matrix4d centred = to_clip;
  centred.col(3) = shift;
  centred_ = centred.cast<float>();
  clip_error_ = float_rounding * roundings * (to_clip.leftCols<3>().cwiseAbs() * half + shift.cwiseAbs());
}

ScreenBounds ScreenBounder::covered(double left, double bottom, double right, double top) const {
  ScreenBounds bounds;
  const double l = std::ceil(left - 0.5), b = std::ceil(bottom - 0.5);
  const double r = std::floor(right - 0.5), t = std::floor(top - 0.5);
  if (!(l <= r && b <= t && r >= rect_.left && l < rect_.right && t >= rect_.bottom && b < rect_.top)) {
    bounds.where = ScreenBounds::Where::outside;
    return bounds;
  }
  bounds.where = ScreenBounds::Where::inside;
  bounds.samples = {
      static_cast<int>(std::max<double>(l, rect_.left)), static_cast<int>(std::max<double>(b, rect_.bottom)),
      static_cast<int>(std::min<double>(r, rect_.right - 1)), static_cast<int>(std::min<double>(t, rect_.top - 1))};
  return bounds;
}

ScreenBounds ScreenBounder::box(const Box& box) const {
  ScreenBounds bounds;
  unsigned outcode = ~0U;
  std::array<Eigen::Vector4d, 8> clip;
  const Eigen::Vector4d margin = clip_error_.array() + clip_error_.w();
  double min_w = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 8; ++k) {
    const Eigen::Vector4d c = to_clip_ * box.corner(static_cast<Box::CornerType>(k)).homogeneous();
    const double depth = c.z() * factor_ + c.w() * offset_;
    outcode &= (c.x() < -c.w() - margin.x() ? 1U : 0U) | (c.x() > c.w() + margin.x() ? 2U : 0U) |
               (c.y() < -c.w() - margin.y() ? 4U : 0U) | (c.y() > c.w() + margin.y() ? 8U : 0U) |
               (depth < -margin.z() ? 16U : 0U) | (depth > c.w() + margin.z() ? 32U : 0U);
    if (!(c.w() >= min_w)) min_w = c.w();
    clip[static_cast<std::size_t>(k)] = c;
  }
  // Frustum culling: all corners are beyond one plane.
  if (outcode != 0) {
    bounds.where = ScreenBounds::Where::outside;
    return bounds;
  }
  // Behind the eye, or so close that rounding errors dominate.
  if (!(min_w > 64 * clip_error_.w())) return bounds;
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const Eigen::Vector4d& c : clip) {
    const Vec3 at = c.head<3>() / c.w();
    low = low.cwiseMin(at);
    high = high.cwiseMax(at);
  }
  if (!(low.allFinite() && high.allFinite())) return bounds;
  const Vec3 largest = low.cwiseAbs().cwiseMax(high.cwiseAbs());
  const Vec3 error = (clip_error_.head<3>() + largest * clip_error_.w()) / min_w +
                     float_rounding * roundings * (largest + Vec3(1, 1, std::abs(offset_)));
  const Vec3 half(half_width_, half_height_, 0);
  const Vec3 room_on_screen = error.cwiseProduct(half).array() + snapping;
  bounds = covered((low.x() + 1) * half.x() - room_on_screen.x(), (low.y() + 1) * half.y() - room_on_screen.y(),
                   (high.x() + 1) * half.x() + room_on_screen.x(), (high.y() + 1) * half.y() + room_on_screen.y());
  return bounds;
}

void ScreenBounder::triangles(const ClusterCorners& corners, ClusterBounds& bounds) const {
  constexpr std::size_t count = max_faces_per_cluster;
  const auto number = [](double value) { return static_cast<float>(value); };
  const float x_room = number(clip_error_.x() + clip_error_.w()), y_room = number(clip_error_.y() + clip_error_.w()),
              z_room = number(clip_error_.z() + clip_error_.w());
  const float factor = number(factor_), offset = number(offset_), abs_factor = std::abs(factor),
              abs_offset = std::abs(offset);
  const float half_width = number(half_width_), half_height = number(half_height_);
  const float ex = number(clip_error_.x()), ey = number(clip_error_.y()), ez = number(clip_error_.z()),
              ew = number(clip_error_.w()), min_reliable_w = 64 * ew, rounding = number(float_rounding * roundings);
  const Eigen::Matrix4f& m = centred_;
  const float rect_left = number(rect_.left), rect_right = number(rect_.right), rect_bottom = number(rect_.bottom),
              rect_top = number(rect_.top);
  constexpr auto anywhere = static_cast<std::int32_t>(ScreenBounds::Where::anywhere);
  static_assert(static_cast<int>(ScreenBounds::Where::outside) == 0 &&
                static_cast<int>(ScreenBounds::Where::inside) == anywhere - 1);
  auto &x = bounds.x, &y = bounds.y, &z = bounds.z;
  float w[count], edges[4][count], extent[count];
  std::int32_t outcode[count];
  for (std::size_t k = 0; k < count; ++k) {
    outcode[k] = 63;
    w[k] = std::numeric_limits<float>::infinity();
    extent[k] = 0;
  }
  // Simple loops over all faces, which compilers vectorise.
  for (std::size_t c = 0; c < 3; ++c) {
    const float* px = corners.at[c][0];
    const float* py = corners.at[c][1];
    const float* pz = corners.at[c][2];
    for (std::size_t k = 0; k < count; ++k) {
      const float cx = m(0, 0) * px[k] + m(0, 1) * py[k] + m(0, 2) * pz[k] + m(0, 3);
      const float cy = m(1, 0) * px[k] + m(1, 1) * py[k] + m(1, 2) * pz[k] + m(1, 3);
      const float cz = m(2, 0) * px[k] + m(2, 1) * py[k] + m(2, 2) * pz[k] + m(2, 3);
      const float cw = m(3, 0) * px[k] + m(3, 1) * py[k] + m(3, 2) * pz[k] + m(3, 3);
      const float depth = cz * factor + cw * offset;
      outcode[k] &= static_cast<std::int32_t>(cx < -cw - x_room) | static_cast<std::int32_t>(cx > cw + x_room) << 1 |
                    static_cast<std::int32_t>(cy < -cw - y_room) << 2 |
                    static_cast<std::int32_t>(cy > cw + y_room) << 3 | static_cast<std::int32_t>(depth < -z_room) << 4 |
                    static_cast<std::int32_t>(depth > cw + z_room) << 5;
      w[k] = cw < w[k] ? cw : w[k];
      const float inverse_w = 1 / cw;
      x[c][k] = cx * inverse_w;
      y[c][k] = cy * inverse_w;
      z[c][k] = cz * inverse_w;
      // Not finite if any coordinate is NaN or infinite.
      extent[k] += std::abs(x[c][k]) + std::abs(y[c][k]) + std::abs(z[c][k]);
    }
  }
  const auto least = [](float a, float b) { return a < b ? a : b; };
  const auto most = [](float a, float b) { return a > b ? a : b; };
  for (std::size_t k = 0; k < count; ++k) {
    const float x0 = least(least(x[0][k], x[1][k]), x[2][k]), x1 = most(most(x[0][k], x[1][k]), x[2][k]);
    const float y0 = least(least(y[0][k], y[1][k]), y[2][k]), y1 = most(most(y[0][k], y[1][k]), y[2][k]);
    const float z0 = least(least(z[0][k], z[1][k]), z[2][k]), z1 = most(most(z[0][k], z[1][k]), z[2][k]);
    const float inverse_w = 1 / w[k];
    const float x_error =
        ((ex + most(-x0, x1) * ew) * inverse_w + rounding * (most(-x0, x1) + 1)) * half_width + number(snapping);
    const float y_error =
        ((ey + most(-y0, y1) * ew) * inverse_w + rounding * (most(-y0, y1) + 1)) * half_height + number(snapping);
    const float z_error =
        ((ez + most(-z0, z1) * ew) * inverse_w + rounding * (most(-z0, z1) + abs_offset)) * abs_factor;
    // Bounds of sample indices as floats, with sample centres at integers: below, the first two are rounded up, and the
    // last two are rounded down minus 1. They are clamped to at least 0 before, so that truncation rounds down.
    edges[0][k] = (x0 + 1) * half_width - x_error - 0.5F;
    edges[1][k] = (y0 + 1) * half_height - y_error - 0.5F;
    edges[2][k] = (x1 + 1) * half_width + x_error + 0.5F;
    edges[3][k] = (y1 + 1) * half_height + y_error + 0.5F;
    // The plane through the corners, in samples and nearness.
    const float abx = (x[1][k] - x[0][k]) * half_width, acx = (x[2][k] - x[0][k]) * half_width;
    const float aby = (y[1][k] - y[0][k]) * half_height, acy = (y[2][k] - y[0][k]) * half_height;
    const float abz = (z[1][k] - z[0][k]) * factor, acz = (z[2][k] - z[0][k]) * factor;
    const float bcx = acx - abx, bcy = acy - aby;
    const float area = std::abs(abx * acy - aby * acx);
    const float longest = most(most(abx * abx + aby * aby, acx * acx + acy * acy), bcx * bcx + bcy * bcy);
    const float shift = x_error + y_error;
    const float lowest = most(number(min_reliable_height), 4 * shift);
    const float slope = (std::abs(aby * acz - abz * acy) + std::abs(abz * acx - abx * acz)) / area;
    const float near_end = most(z0 * factor, z1 * factor) + offset + slope * shift + 2 * z_error;
    bounds.moved[k] = shift;
    bounds.error[k] = 2 * z_error;
    bounds.nearness[k] = area * area > longest * lowest * lowest ? near_end : std::numeric_limits<float>::infinity();
  }
  // Clamps to the rectangle, so that the conversion to integers is defined. One bound at a time: clamping to both at
  // once compiles to branches.
  for (int e = 0; e < 4; ++e) {
    const float low = e % 2 == 0 ? rect_left : rect_bottom, high = e % 2 == 0 ? rect_right : rect_top;
    for (std::size_t k = 0; k < count; ++k) edges[e][k] = most(edges[e][k], low);
    for (std::size_t k = 0; k < count; ++k) edges[e][k] = least(edges[e][k], high);
  }
  // First and last sample whose centres are within the bounds.
  for (std::size_t k = 0; k < count; ++k) {
    const auto up = [](float value) {
      const auto whole = static_cast<std::int32_t>(value);
      return whole + static_cast<std::int32_t>(static_cast<float>(whole) < value);
    };
    bounds.left[k] = up(edges[0][k]);
    bounds.bottom[k] = up(edges[1][k]);
    bounds.right[k] = static_cast<std::int32_t>(edges[2][k]) - 1;
    bounds.top[k] = static_cast<std::int32_t>(edges[3][k]) - 1;
  }
  for (std::size_t k = 0; k < count; ++k) {
    // Comparisons with NaN are false, so that NaN is never sound.
    const std::int32_t reliable = static_cast<std::int32_t>(w[k] > min_reliable_w) &
                                  static_cast<std::int32_t>(extent[k] < std::numeric_limits<float>::infinity());
    const std::int32_t none = static_cast<std::int32_t>(outcode[k] != 0) |
                              (reliable & (static_cast<std::int32_t>(bounds.left[k] > bounds.right[k]) |
                                           static_cast<std::int32_t>(bounds.bottom[k] > bounds.top[k])));
    bounds.where[k] = (1 - none) * (anywhere - reliable);
  }
}

ScreenTriangle ScreenBounder::triangle(const ClusterBounds& bounds, std::size_t k) const {
  ScreenTriangle result;
  result.samples = bounds.samples(k);
  for (std::size_t c = 0; c < 3; ++c) {
    result.x[c] = (static_cast<double>(bounds.x[c][k]) + 1) * half_width_;
    result.y[c] = (static_cast<double>(bounds.y[c][k]) + 1) * half_height_;
    result.nearness[c] = static_cast<double>(bounds.z[c][k]) * factor_ + offset_;
  }
  result.moved = static_cast<double>(bounds.moved[k]);
  result.error = static_cast<double>(bounds.error[k]);
  return result;
}

}  // namespace rebake
