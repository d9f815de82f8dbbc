#include "render/flip.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/types.h"
#include "mesh_ops/scene/scene_light.h"

// Names and constants as in the paper: P. Andersson, J. Nilsson, T. Akenine-Möller, M. Oskarsson, K. Åström,
// M. D. Fairchild: FLIP, a difference evaluator for alternating images, HPG 2020.
namespace rebake {

namespace {

using Plane = std::vector<double>;
using Planes = std::array<Plane, 3>;

// Linear sRGB to CIE XYZ (IEC 61966-2-1, D65).
Mat3 rgb_to_xyz() {
  Mat3 m;
  m << 10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794,  //
      2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897,     //
      1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382;
  return m;
}
const Mat3 to_xyz = rgb_to_xyz(), from_xyz = rgb_to_xyz().inverse();
const Vec3 white = rgb_to_xyz() * Vec3(1, 1, 1);

// Linear variant of CIELAB, in which filters act.
Vec3 ycxcz(const Vec3& linear) {
  const Vec3 p = (to_xyz * linear).cwiseQuotient(white);
  return {116 * p.y() - 16, 500 * (p.x() - p.y()), 200 * (p.y() - p.z())};
}
Vec3 linear_of(const Vec3& opponent) {
  const double y = (opponent.x() + 16) / 116;
  const Vec3 p(y + opponent.y() / 500, y, y - opponent.z() / 200);
  return from_xyz * p.cwiseProduct(white);
}

// CIELAB, with less chroma for dark colours (Hunt effect).
Vec3 hunt_lab(const Vec3& linear) {
  constexpr double delta = 6.0 / 29;
  const Vec3 p = (to_xyz * linear).cwiseQuotient(white).unaryExpr([](double t) {
    return t > delta * delta * delta ? std::cbrt(t) : t / (3 * delta * delta) + 4.0 / 29;
  });
  const double l = 116 * p.y() - 16;
  return {l, 0.01 * l * 500 * (p.x() - p.y()), 0.01 * l * 200 * (p.y() - p.z())};
}
double hyab(const Vec3& a, const Vec3& b) { return std::abs(a.x() - b.x()) + std::hypot(a.y() - b.y(), a.z() - b.z()); }

// The sum over a square kernel around each pixel; border pixels are repeated.
template <class Kernel>
Plane filtered(const Plane& in, int width, int height, int radius, const Kernel& kernel) {
  const int side = 2 * radius + 1;
  std::vector<double> weights;
  for (int y = -radius; y <= radius; ++y)
    for (int x = -radius; x <= radius; ++x) weights.push_back(kernel(x, y));
  Plane out(in.size());
  tbb::parallel_for(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      double sum = 0;
      for (int dy = 0; dy < side; ++dy) {
        const double* const row =
            &in[static_cast<std::size_t>(std::clamp(y + dy - radius, 0, height - 1)) * static_cast<std::size_t>(width)];
        for (int dx = 0; dx < side; ++dx)
          sum += weights[static_cast<std::size_t>(dy * side + dx)] * row[std::clamp(x + dx - radius, 0, width - 1)];
      }
      out[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] = sum;
    }
  });
  return out;
}

// Contrast sensitivity of one channel: sums of two Gaussians, in degrees.
struct Sensitivity {
  double a1, b1, a2, b2;
  double operator()(double squared_degrees) const {
    constexpr double pi = std::numbers::pi;
    return a1 * std::sqrt(pi / b1) * std::exp(-pi * pi * squared_degrees / b1) +
           a2 * std::sqrt(pi / b2) * std::exp(-pi * pi * squared_degrees / b2);
  }
};
constexpr std::array<Sensitivity, 3> sensitivities{Sensitivity{1, 0.0047, 0, 1e-5}, Sensitivity{1, 0.0053, 0, 1e-5},
                                                   Sensitivity{34.1, 0.04, 13.5, 0.025}};

Planes opponent_planes(const Image& image) {
  Planes planes;
  for (std::size_t p = 0; p < image.rgb.size(); p += 3) {
    const auto linear = [&](std::size_t c) { return to_linear(image.rgb[p + c] / 255.0); };
    const Vec3 value = ycxcz({linear(0), linear(1), linear(2)});
    for (std::size_t c = 0; c < 3; ++c) planes[c].push_back(value[static_cast<Eigen::Index>(c)]);
  }
  return planes;
}

// Colours after contrast sensitivity.
std::vector<Vec3> seen_colors(const Planes& planes, int width, int height, double pixels_per_degree) {
  constexpr double widest = 0.04;
  const int radius = static_cast<int>(
      std::ceil(3 * std::sqrt(widest / (2 * std::numbers::pi * std::numbers::pi)) * pixels_per_degree));
  Planes seen;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto raw = [&](int x, int y) {
      return sensitivities[c]((x * x + y * y) / (pixels_per_degree * pixels_per_degree));
    };
    double sum = 0;
    for (int y = -radius; y <= radius; ++y)
      for (int x = -radius; x <= radius; ++x) sum += raw(x, y);
    seen[c] = filtered(planes[c], width, height, radius, [&](int x, int y) { return raw(x, y) / sum; });
  }
  std::vector<Vec3> colors;
  for (std::size_t p = 0; p < seen[0].size(); ++p)
    colors.push_back(hunt_lab(linear_of({seen[0][p], seen[1][p], seen[2][p]}).cwiseMax(0.0).cwiseMin(1.0)));
  return colors;
}

// Strengths of edges and of points per pixel.
struct Features {
  Plane edges, points;
};
Features features_of(const Plane& lightness, int width, int height, double pixels_per_degree) {
  constexpr double detector_width = 0.082;  // degrees
  const double deviation = 0.5 * detector_width * pixels_per_degree, variance = deviation * deviation;
  const int radius = static_cast<int>(std::ceil(3 * deviation));
  Plane normalised = lightness;
  for (double& y : normalised) y = (y + 16) / 116;
  // Positive and negative weights sum to 1 and −1.
  const auto strength = [&](const auto& along) {
    double positive = 0, negative = 0;
    const auto raw = [&](int x, int y) { return along(x) * std::exp(-(x * x + y * y) / (2 * variance)); };
    for (int y = -radius; y <= radius; ++y)
      for (int x = -radius; x <= radius; ++x) (raw(x, y) > 0 ? positive : negative) += raw(x, y);
    const auto weight = [&](int x, int y) {
      const double value = raw(x, y);
      return value > 0 ? value / positive : -value / negative;
    };
    const Plane across = filtered(normalised, width, height, radius, weight);
    Plane result = filtered(normalised, width, height, radius, [&](int x, int y) { return weight(y, x); });
    for (std::size_t p = 0; p < result.size(); ++p) result[p] = std::hypot(result[p], across[p]);
    return result;
  };
  return {strength([](int x) { return -static_cast<double>(x); }),
          strength([&](int x) { return x * x / variance - 1; })};
}

}  // namespace

std::vector<double> flip_map(const Image& reference, const Image& test, double pixels_per_degree) {
  if (reference.width != test.width || reference.height != test.height)
    throw Error(fmt::format("the pictures differ in size: {}×{} and {}×{}", reference.width, reference.height,
                            test.width, test.height));
  const int width = reference.width, height = reference.height;
  const Planes a = opponent_planes(reference), b = opponent_planes(test);
  const std::vector<Vec3> seen_a = seen_colors(a, width, height, pixels_per_degree),
                          seen_b = seen_colors(b, width, height, pixels_per_degree);
  const Features shape_a = features_of(a[0], width, height, pixels_per_degree),
                 shape_b = features_of(b[0], width, height, pixels_per_degree);
  // Exponents of colour and features; errors below pc · largest take up a share pt of the range.
  constexpr double qc = 0.7, qf = 0.5, pc = 0.4, pt = 0.95;
  const double largest = std::pow(hyab(hunt_lab({0, 1, 0}), hunt_lab({0, 0, 1})), qc);
  std::vector<double> map;
  for (std::size_t p = 0; p < seen_a.size(); ++p) {
    const double raw = std::pow(hyab(seen_a[p], seen_b[p]), qc);
    const double color = raw < pc * largest ? pt / (pc * largest) * raw
                                            : pt + (raw - pc * largest) / (largest - pc * largest) * (1 - pt);
    const double shape =
        std::max(std::abs(shape_a.edges[p] - shape_b.edges[p]), std::abs(shape_a.points[p] - shape_b.points[p]));
    map.push_back(std::pow(std::min(color, 1.0), 1 - std::pow(std::numbers::sqrt2 / 2 * shape, qf)));
  }
  return map;
}

}  // namespace rebake
