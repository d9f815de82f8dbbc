#include "render/panorama.h"

#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <numbers>

#include "mesh_ops/base/error.h"

namespace rebake {

namespace {

// A picture that looks along an axis of the panorama's frame.
struct Side {
  Mat3 rows;  // right, up, back
  Image picture;
};

constexpr int margin = 2;  // pixels around 90°, for the resampling at edges

// The picture of a side at a direction in its frame (right, up, back), as premultiplied RGBA.
std::array<double, 4> sampled(const Side& side, const Vec3& q) {
  const int size = side.picture.width, inner = size - 2 * margin;
  const double x = (q.x() / -q.z() + 1) / 2 * inner + margin - 0.5, y = (1 - q.y() / -q.z()) / 2 * inner + margin - 0.5;
  const int left = std::clamp(static_cast<int>(std::floor(x)), 0, size - 2),
            top = std::clamp(static_cast<int>(std::floor(y)), 0, size - 2);
  std::array<double, 4> sum{};
  for (const int dy : {0, 1})
    for (const int dx : {0, 1}) {
      const std::size_t pixel =
          static_cast<std::size_t>(top + dy) * static_cast<std::size_t>(size) + static_cast<std::size_t>(left + dx);
      const double alpha = side.picture.alpha.empty() ? 1 : side.picture.alpha[pixel] / 255.0,
                   weight = (dx == 1 ? x - left : 1 - (x - left)) * (dy == 1 ? y - top : 1 - (y - top));
      for (std::size_t c = 0; c < 3; ++c) sum[c] += weight * alpha * side.picture.rgb[3 * pixel + c];
      sum[3] += weight * alpha;
    }
  return sum;
}

}  // namespace

Image render_panorama(Renderer& renderer, const Scene& scene, const View& view, const RenderOptions& options,
                      const Lighting* lighting) {
  if (view.width != 2 * view.height)
    throw FieldError("width", "of a picture of all directions must be twice its height");
  // The level frame: right, up, back.
  const Vec3 up = view.camera.up.normalized(), towards = view.camera.target - view.camera.eye;
  Vec3 ahead = towards - towards.dot(up) * up;
  if (!(ahead.norm() > 1e-9 * towards.norm())) ahead = up.unitOrthogonal();
  Mat3 level;
  level.row(2) = -ahead.normalized();
  level.row(1) = up;
  level.row(0) = up.cross(Vec3(level.row(2).transpose()));
  const int inner = std::max(2, view.width / 2);
  std::vector<Side> sides;
  for (const auto& [forward, top] :
       {std::pair(Vec3(0, 0, -1), Vec3(0, 1, 0)), std::pair(Vec3(0, 0, 1), Vec3(0, 1, 0)),
        std::pair(Vec3(1, 0, 0), Vec3(0, 1, 0)), std::pair(Vec3(-1, 0, 0), Vec3(0, 1, 0)),
        std::pair(Vec3(0, 1, 0), Vec3(0, 0, 1)), std::pair(Vec3(0, -1, 0), Vec3(0, 0, -1))}) {
    Side side;
    side.rows.row(0) = forward.cross(top);
    side.rows.row(1) = top;
    side.rows.row(2) = -forward;
    View one = view;
    one.width = one.height = inner + 2 * margin;
    one.camera.target = view.camera.eye + level.transpose() * forward;
    one.camera.up = level.transpose() * top;
    one.camera.ortho_height = 0;
    one.camera.fov_degrees = 2 * std::atan(static_cast<double>(inner + 2 * margin) / inner) * 180 / std::numbers::pi;
    side.picture = renderer.render(scene, one, options, lighting);
    sides.push_back(std::move(side));
  }
  const auto width = static_cast<std::size_t>(view.width), height = static_cast<std::size_t>(view.height);
  Image result{view.width, view.height, std::vector<std::uint8_t>(3 * width * height), {}};
  if (options.transparent) result.alpha.resize(width * height);
  tbb::parallel_for(std::size_t{0}, height, [&](std::size_t y) {
    const double above = std::numbers::pi * (0.5 - (static_cast<double>(y) + 0.5) / static_cast<double>(height));
    for (std::size_t x = 0; x < width; ++x) {
      const double about = std::numbers::pi * (2 * (static_cast<double>(x) + 0.5) / static_cast<double>(width) - 1);
      const Vec3 d(std::sin(about) * std::cos(above), std::sin(above), -std::cos(about) * std::cos(above));
      const Side* best = nullptr;
      for (const Side& side : sides)
        if (best == nullptr || side.rows.row(2).dot(d) < best->rows.row(2).dot(d)) best = &side;
      const std::array<double, 4> color = sampled(*best, best->rows * d);
      for (std::size_t c = 0; c < 3; ++c)
        result.rgb[3 * (y * width + x) + c] =
            color[3] > 0 ? static_cast<std::uint8_t>(std::lround(std::min(255.0, color[c] / color[3]))) : 0;
      if (options.transparent) result.alpha[y * width + x] = static_cast<std::uint8_t>(std::lround(255 * color[3]));
    }
  });
  return result;
}

}  // namespace rebake
