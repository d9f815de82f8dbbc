#include "mesh_ops/reconstruction/capture_frame.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mesh_ops/base/error.h"
#include "mesh_ops/scene/scene_light.h"

namespace rebake {

namespace {

constexpr int voxels = 64;           // per side of the carved cube
constexpr double most_carved = 0.1;  // share of the photographs in which a voxel may show background
constexpr int tolerance = 6;         // of 255, between background pixels
constexpr double least_even = 0.9;   // share of border pixels of an even background

using Bytes = std::array<std::uint8_t, 3>;

bool alike(const std::uint8_t* a, const Bytes& b) {
  return std::abs(int{a[0]} - b[0]) <= tolerance && std::abs(int{a[1]} - b[1]) <= tolerance &&
         std::abs(int{a[2]} - b[2]) <= tolerance;
}

// Foreground pixels, summed so that windows are counted in constant time.
class Silhouette {
 public:
  Silhouette(const FitPhotograph& photograph, const Bytes& background)
      : width_(photograph.width), height_(photograph.height), sums_(at(0, height_ + 1)) {
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x < width_; ++x) {
        const std::size_t p =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
        // What a mask leaves out may be anything.
        const bool foreground = photograph.valid[p] == 0 || !alike(&photograph.rgb[3 * p], background);
        sums_[at(x + 1, y + 1)] = sums_[at(x, y + 1)] + sums_[at(x + 1, y)] - sums_[at(x, y)] + (foreground ? 1 : 0);
      }
  }
  /// Whether a window of this half width (pixels) around a point shows foreground. Nothing if it lies outside.
  std::optional<bool> shows(const Vec2& point, double half) const {
    const double left = point.x() - half, right = point.x() + half, top = point.y() - half, bottom = point.y() + half;
    if (!(left < width_ && right > 0 && top < height_ && bottom > 0)) return std::nullopt;
    const int x0 = std::max(0, static_cast<int>(std::floor(left))),
              x1 = std::min(width_, static_cast<int>(std::ceil(right))),
              y0 = std::max(0, static_cast<int>(std::floor(top))),
              y1 = std::min(height_, static_cast<int>(std::ceil(bottom)));
    return sums_[at(x1, y1)] - sums_[at(x0, y1)] - sums_[at(x1, y0)] + sums_[at(x0, y0)] > 0;
  }

 private:
  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_ + 1) + static_cast<std::size_t>(x);
  }
  int width_, height_;
  std::vector<std::uint32_t> sums_;
};

// The colour of nearly all valid pixels along a photograph's border; nothing if there is none.
std::optional<Bytes> even_border(const FitPhotograph& photograph) {
  std::vector<Bytes> border;
  for (int y = 0; y < photograph.height; ++y)
    for (int x = 0; x < photograph.width; ++x) {
      if (y > 0 && y + 1 < photograph.height && x > 0 && x + 1 < photograph.width) continue;
      const std::size_t p =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(photograph.width) + static_cast<std::size_t>(x);
      if (photograph.valid[p] != 0)
        border.push_back({photograph.rgb[3 * p], photograph.rgb[3 * p + 1], photograph.rgb[3 * p + 2]});
    }
  if (border.empty()) return std::nullopt;
  Bytes middle{};
  for (std::size_t c = 0; c < 3; ++c) {
    const auto half = border.begin() + static_cast<std::ptrdiff_t>(border.size() / 2);
    std::nth_element(border.begin(), half, border.end(), [&](const Bytes& a, const Bytes& b) { return a[c] < b[c]; });
    middle[c] = (*half)[c];
  }
  const auto even =
      std::count_if(border.begin(), border.end(), [&](const Bytes& one) { return alike(one.data(), middle); });
  if (static_cast<double>(even) < least_even * static_cast<double>(border.size())) return std::nullopt;
  return middle;
}

struct Cube {
  Vec3 middle;
  double half;
};

// What all cameras see around the point that they look at.
Cube seen_cube(const std::vector<FitPhotograph>& photographs) {
  Cube cube{Vec3::Zero(), 0};
  for (const FitPhotograph& one : photographs)
    cube.middle += one.camera.target / static_cast<double>(photographs.size());
  for (const FitPhotograph& one : photographs) {
    const double aspect = static_cast<double>(one.width) / one.height,
                 tangent = std::tan(one.camera.fov_degrees * std::numbers::pi / 360);
    cube.half = std::max(cube.half, (one.camera.eye - cube.middle).norm() * tangent * std::max(1.0, aspect));
  }
  return cube;
}

// The box of the voxels that hardly any photograph shows as background; empty if there are none.
Box carved(const std::vector<FitPhotograph>& photographs, const std::vector<Silhouette>& silhouettes,
           const Cube& cube) {
  const double size = 2 * cube.half / voxels;
  std::vector<Box> boxes(voxels);
  tbb::parallel_for(0, voxels, [&](int z) {
    for (int y = 0; y < voxels; ++y)
      for (int x = 0; x < voxels; ++x) {
        const Vec3 point = cube.middle + size * (Vec3(x, y, z).array() + 0.5 - voxels / 2.0).matrix();
        std::size_t inside = 0, empty = 0;
        for (std::size_t k = 0; k < photographs.size(); ++k) {
          const FitPhotograph& one = photographs[k];
          const Vec3 seen = world_to_camera(one.camera) * (point - one.camera.eye);
          if (!(seen.z() < 0)) continue;
          const double focal = one.height / (2 * std::tan(one.camera.fov_degrees * std::numbers::pi / 360)),
                       scale = focal / -seen.z();
          const auto shows =
              silhouettes[k].shows(Vec2(one.width / 2.0 + scale * seen.x(), one.height / 2.0 - scale * seen.y()),
                                   0.5 * std::sqrt(3.0) * size * scale);
          if (!shows) continue;
          ++inside;
          empty += *shows ? 0 : 1;
        }
        // An object is in most photographs.
        if (2 * inside >= photographs.size() && static_cast<double>(empty) <= most_carved * static_cast<double>(inside))
          boxes[static_cast<std::size_t>(z)].extend(Box(point.array() - size / 2, point.array() + size / 2));
      }
  });
  Box all;
  for (const Box& box : boxes) all.extend(box);
  return all;
}

// Background and exposures by the colours along the borders of the photographs.
void find_background(const std::vector<Bytes>& borders, CaptureFrame& frame) {
  if (!std::all_of(borders.begin(), borders.end(), [&](const Bytes& one) { return alike(one.data(), borders[0]); })) {
    for (const Bytes& border : borders) {
      Vec3 gain;
      for (std::size_t c = 0; c < 3; ++c) {
        const auto at = static_cast<Eigen::Index>(c);
        gain[at] = std::max(to_linear(border[c] / 255.0), 1e-3) / std::max(to_linear(frame.background[at]), 1e-3);
      }
      frame.gains.push_back(gain);
    }
    frame.notes.emplace_back(
        "exposures: photographs have even backgrounds of different brightness, so each has a gain");
    return;
  }
  const Vec3 color = Vec3(borders[0][0], borders[0][1], borders[0][2]) / 255;
  if ((color - frame.background).cwiseAbs().maxCoeff() <= tolerance / 255.0) return;
  frame.background = color;
  frame.notes.push_back(
      fmt::format("background: ({:.2f}, {:.2f}, {:.2f}), the colour along the borders of all photographs", color.x(),
                  color.y(), color.z()));
}

}  // namespace

CaptureFrame object_frame(const std::vector<FitPhotograph>& photographs, const Vec3& background, double margin) {
  if (photographs.empty()) throw Error("there is no photograph");
  Cube cube = seen_cube(photographs);
  if (!(cube.half > 0)) throw Error("all cameras are at the point that they look at");
  CaptureFrame frame;
  frame.background = background;
  std::vector<Silhouette> silhouettes;
  std::vector<Bytes> borders;
  for (const FitPhotograph& one : photographs)
    if (const auto border = even_border(one)) {
      silhouettes.emplace_back(one, *border);
      borders.push_back(*border);
    }
  const bool even = silhouettes.size() == photographs.size();
  bool found = false;
  // The second pass is finer.
  for (int pass = 0; even && pass < 2; ++pass) {
    const Box box = carved(photographs, silhouettes, cube);
    if (box.isEmpty()) break;
    found = true;
    cube = {box.center(), box.sizes().maxCoeff() / 2};
  }
  if (even) find_background(borders, frame);
  cube.half /= 1 - 2 * margin;
  frame.to_unit = Eigen::Scaling(1 / cube.half) * Eigen::Translation3d(-cube.middle);
  frame.notes.push_back(fmt::format(
      "grid: cube of side {:.4g} around ({:.4g}, {:.4g}, {:.4g}), {}", 2 * cube.half, cube.middle.x(), cube.middle.y(),
      cube.middle.z(),
      found ? "from the silhouettes" : "from what the cameras see: the photographs have no even background"));
  return frame;
}

}  // namespace rebake
