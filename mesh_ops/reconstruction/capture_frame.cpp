#include "mesh_ops/reconstruction/capture_frame.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
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

Vec3 display_of(const Vec3& linear) {
  return linear.unaryExpr([](double value) { return to_display(std::clamp(value, 0.0, 1.0)); });
}

// Background and exposures by the colours along the borders of the photographs.
void find_background(const std::vector<Bytes>& borders, CaptureFrame& frame) {
  std::vector<Vec3> linear;
  Vec3 logs = Vec3::Zero(), sum = Vec3::Zero(), brightest = Vec3::Zero();
  constexpr double darkest = 0.05;  // darker backgrounds tell no exposure
  bool exposures = true;
  for (const Bytes& border : borders) {
    Vec3& light = linear.emplace_back();
    for (std::size_t c = 0; c < 3; ++c) light[static_cast<Eigen::Index>(c)] = to_linear(border[c] / 255.0);
    exposures = exposures && light.minCoeff() >= darkest;
    logs += light.cwiseMax(1e-6).array().log().matrix() / static_cast<double>(borders.size());
    sum += light / static_cast<double>(borders.size());
    if (light.sum() > brightest.sum()) brightest = light;
  }
  const Vec3 mean = logs.array().exp().matrix();
  const auto alike_all = [&](const Bytes& one) { return alike(one.data(), borders[0]); };
  const bool same = std::all_of(borders.begin(), borders.end(), alike_all);
  // Exposure changes all channels alike; white balance a little.
  constexpr double most_tint = 1.25;
  for (const Vec3& light : linear) {
    const Vec3 gain = light.cwiseQuotient(mean);
    exposures = exposures && gain.maxCoeff() <= most_tint * gain.minCoeff();
  }
  Vec3 color = same ? display_of(linear[0]) : display_of(sum);
  if (!same && exposures) {
    // A white background that the brightest photographs show is white; others are in the middle of the exposures.
    constexpr double white = 0.8;
    const Vec3 reference = brightest.minCoeff() >= white ? brightest : mean;
    for (const Vec3& light : linear) frame.gains.push_back(light.cwiseQuotient(reference));
    color = display_of(reference);
  }
  if ((color - frame.background).cwiseAbs().maxCoeff() <= tolerance / 255.0) return;
  frame.background = color;
  frame.notes.push_back(fmt::format("background: ({:.2f}, {:.2f}, {:.2f}), from the borders of the photographs",
                                    color.x(), color.y(), color.z()));
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
  frame.notes.push_back(
      fmt::format("grid: cube of side {:.4g} around ({:.4g}, {:.4g}, {:.4g}), {}", 2 * cube.half, cube.middle.x(),
                  cube.middle.y(), cube.middle.z(),
                  found  ? "from the silhouettes"
                  : even ? "from the cameras, because the silhouettes do not agree: check the poses, world and scale"
                         : "from the cameras, because photographs have no even background"));
  return frame;
}

namespace {

// Mean of one of the axes of all cameras: 0 right, 1 up, 2 back.
Vec3 mean_axis(const std::vector<FitPhotograph>& photographs, int axis) {
  Vec3 sum = Vec3::Zero();
  for (const FitPhotograph& one : photographs) sum += world_to_camera(one.camera).row(axis).transpose();
  return sum / static_cast<double>(photographs.size());
}

Vec3 mean_eye(const std::vector<FitPhotograph>& photographs) {
  Vec3 sum = Vec3::Zero();
  for (const FitPhotograph& one : photographs) sum += one.camera.eye;
  return sum / static_cast<double>(photographs.size());
}

// Rows x, y and z of a rotation, from z and roughly y.
Mat3 rotation_with(const Vec3& z, const Vec3& y) {
  Mat3 rows;
  rows.row(2) = z.normalized();
  rows.row(0) = y.cross(z).normalized();
  rows.row(1) = rows.row(2).cross(rows.row(0));
  return rows;
}

}  // namespace

CaptureFrame forward_frame(const std::vector<FitPhotograph>& photographs, double near, double far) {
  if (photographs.empty()) throw Error("there is no photograph");
  const Vec3 back = mean_axis(photographs, 2), up = mean_axis(photographs, 1), eye = mean_eye(photographs);
  constexpr double least = 0.5;  // cosine of the spread of view directions
  if (!(back.norm() > least && up.cross(back).norm() > least * least))
    throw Error("the cameras look in different directions: is this a forward-facing capture?");
  const Mat3 turn = rotation_with(back, up);
  CaptureFrame frame;
  std::string assumed;
  double distance = 0, stated_near = std::numeric_limits<double>::infinity(), stated_far = 0;
  for (const FitPhotograph& one : photographs) {
    distance += (one.camera.target - one.camera.eye).norm() / static_cast<double>(photographs.size());
    if (one.camera.near_plane > 0) stated_near = std::min(stated_near, one.camera.near_plane);
    stated_far = std::max(stated_far, one.camera.far_plane);
  }
  if (near == 0 && std::isfinite(stated_near)) near = stated_near;
  if (far == 0 && stated_far > near) far = stated_far;
  if (near == 0) {
    near = far > 0 ? std::min(distance / 2, far / 2) : distance / 2;
    assumed = "near";
  }
  if (far == 0) {
    far = std::max(10 * distance, 4 * near);
    assumed += assumed.empty() ? "far" : " and far";
  }
  if (!(far > near))
    throw Error(fmt::format("the farthest depth, {:.4g}, is not above the nearest, {:.4g}", far, near));
  constexpr double nearest = 4.0 / 3, widest = 0.875;
  const double scale = nearest / near;
  frame.to_unit = Eigen::Scaling(scale) * Affine(turn) * Eigen::Translation3d(-eye);
  frame.frustum.farthest = std::max(2.0, 1.1 * scale * far);
  double slope = 0;
  for (const FitPhotograph& one : photographs) {
    const Vec3 place = frame.to_unit * one.camera.eye;
    const double tangent = std::tan(one.camera.fov_degrees * std::numbers::pi / 360),
                 aspect = static_cast<double>(one.width) / one.height;
    const Mat3 to_frame = turn * world_to_camera(one.camera).transpose();
    for (int corner = 0; corner < 4; ++corner) {
      const int right = corner % 2 * 2 - 1, above = corner / 2 * 2 - 1;
      const Vec3 ray = to_frame * Vec3(right * tangent * aspect, above * tangent, -1);
      // Where the corner of the picture is at the nearest depth, and in the distance.
      for (const double depth : {nearest, 1e6}) {
        const Vec3 point = place + (depth + place.z()) / -ray.z() * ray;
        if (ray.z() < 0) slope = std::max(slope, std::max(std::abs(point.x()), std::abs(point.y())) / depth);
      }
    }
  }
  frame.frustum.slope = std::clamp(1.05 * slope, 0.1, widest);
  frame.notes.push_back(fmt::format(
      "grid: a frustum from depth {:.4g} to {:.4g}{}", near / nearest, frame.frustum.farthest / scale,
      assumed.empty() ? "" : "; depths are assumed from the point that the cameras look at: give " + assumed));
  return frame;
}

CaptureFrame unbounded_frame(const std::vector<FitPhotograph>& photographs) {
  if (photographs.empty()) throw Error("there is no photograph");
  const Vec3 up = mean_axis(photographs, 1), eye = mean_eye(photographs);
  constexpr double least = 0.3;
  if (!(up.norm() > least)) throw Error("the cameras have no common upward direction");
  const Vec3 z = up.normalized(), other = std::abs(z.x()) < 0.7 ? Vec3::UnitX() : Vec3::UnitY();
  const Mat3 turn = rotation_with(z, other.cross(z).cross(z));
  double reach = 0;
  for (const FitPhotograph& one : photographs)
    reach = std::max(reach, (turn * (one.camera.eye - eye)).cwiseAbs().maxCoeff());
  if (!(reach > 0)) throw Error("all cameras are at the same place");
  CaptureFrame frame;
  frame.to_unit = Eigen::Scaling(1 / reach) * Affine(turn) * Eigen::Translation3d(-eye);
  frame.notes.push_back(fmt::format(
      "grid: a cube of side {:.4g} around the cameras, ({:.4g}, {:.4g}, {:.4g}), and nested boxes to 16 times that",
      2 * reach, eye.x(), eye.y(), eye.z()));
  return frame;
}

}  // namespace rebake
