#include <cmath>
#include <numbers>

#include "samples/bakery/surface.h"

// A glossy enamel kettle with strong view dependence.

namespace rebake::bakery {

using std::numbers::pi;

Model kettle() {
  Model m;
  m.name = "kettle";
  m.layout = Layout::chunked;
  const auto enamel = [](double u, double v, const Vec3&) -> Vec3 {
    const bool spot = std::pow(std::fmod(u * 12, 1.0) - 0.5, 2) + std::pow((v - 0.4) * 7, 2) < 0.06;
    return spot ? Vec3(0.75, 0.72, 0.62) : Vec3(0.05, 0.16, 0.34);
  };
  const auto add = [&](const char* name, std::function<Vec3(double, double)> point, int columns, int rows,
                       std::function<Vec3(double, double, const Vec3&)> albedo, double reflectance, double sharpness) {
    Patch p{name, std::move(point), columns, rows, std::move(albedo)};
    p.reflectance = reflectance;
    p.sharpness = sharpness;
    m.patches.push_back(std::move(p));
  };
  add("body", revolved([](double v) -> Vec2 {
        const double a = -0.95 + 2.2 * v;
        return {0.62 * std::cos(a) + 0.02, 0.5 * std::sin(a)};
      }),
      40, 16, enamel, 0.09, 14);
  add(
      "bottom", revolved([](double v) -> Vec2 {
        return {0.38 * v + 1e-4, -0.407};
      }),
      16, 3,
      [](double, double, const Vec3&) -> Vec3 {
        return {0.1, 0.1, 0.1};
      },
      0, 20);
  add(
      "lid", revolved([](double v) -> Vec2 {
        return {0.24 * std::cos(0.5 * pi * v) + 1e-4, 0.46 + 0.09 * std::sin(0.5 * pi * v)};
      }),
      24, 4,
      [](double, double, const Vec3&) -> Vec3 {
        return {0.05, 0.16, 0.34};
      },
      0.09, 14);
  add(
      "knob", revolved([](double v) -> Vec2 {
        return {0.065 * std::sin(pi * v) + 1e-4, 0.60 - 0.065 * std::cos(pi * v)};
      }),
      12, 6,
      [](double, double, const Vec3&) -> Vec3 {
        return {0.05, 0.04, 0.035};
      },
      0.05, 10);
  add(
      "spout",
      tube(
          [](double v) -> Vec3 {
            return {0.5 + 0.42 * v, -0.08 + 0.42 * v + 0.12 * v * v, 0};
          },
          [](double v) { return 0.11 - 0.055 * v; }),
      14, 10,
      [](double, double, const Vec3&) -> Vec3 {
        return {0.05, 0.16, 0.34};
      },
      0.09, 14);
  add(
      "handle",
      tube(
          [](double v) -> Vec3 {
            return {-0.42 * std::cos(pi * v), 0.38 + 0.55 * std::sin(pi * v), 0};
          },
          [](double) { return 0.035; }),
      10, 22,
      [](double, double v, const Vec3& p) -> Vec3 {
        return v > 0.3 && v < 0.7 ? Vec3(Vec3(0.35, 0.2, 0.1) * (0.7 + 0.6 * noise(p * 20))) : Vec3(0.2, 0.2, 0.2);
      },
      0.05, 10);
  m.camera = orbit_cameras({0.1, 0.1, 0}, 3.2, 0, 70);
  return m;
}

}  // namespace rebake::bakery
