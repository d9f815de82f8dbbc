#include <cmath>
#include <numbers>

#include "samples/bakery/surface.h"

// An unbounded scene, seen from within, with a far backdrop; coordinates within ±16.

namespace rebake::bakery {

using std::numbers::pi;

Model courtyard() {
  Model m;
  m.name = "courtyard";
  const auto stone = [](const Vec3& tint) {
    return [tint](double, double, const Vec3& p) -> Vec3 {
      return tint * (0.65 + 0.5 * noise(p * 3) + 0.2 * noise(p * 11));
    };
  };
  const auto tiles = [](double, double, const Vec3& p) -> Vec3 {
    const double gx = std::abs(std::fmod(std::abs(p.x()) * 1.5, 1.0) - 0.5),
                 gz = std::abs(std::fmod(std::abs(p.z()) * 1.5, 1.0) - 0.5);
    return Vec3(0.42, 0.34, 0.26) * (gx > 0.46 || gz > 0.46 ? 0.55 : 0.8 + 0.4 * noise(p * 4));
  };
  m.patches.push_back({"ground", plane({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}), 22, 22, tiles});
  m.patches.push_back({"far ground", revolved([](double v) -> Vec2 {
                         return {15.9 - 13.2 * v, -0.02};
                       }),
                       28, 8, stone({0.28, 0.34, 0.16})});
  for (int side = 0; side < 4; ++side) {
    const Mat3 turn = Eigen::AngleAxisd(side * pi / 2, Vec3::UnitY()).toRotationMatrix();
    Patch wall{"wall " + std::to_string(side), plane(turn * Vec3(-3, 0, -3), turn * Vec3(6, 0, 0), {0, 1.9, 0}), 18, 6,
               stone({0.62, 0.5, 0.36})};
    wall.opaque = [](double u, double v) {
      const double x = std::fmod(u * 5, 1.0) - 0.5, y = v - 0.5;
      return !(std::abs(x) < 0.32 && (y < 0 || x * x / (0.32 * 0.32) + y * y / 0.09 < 1));
    };
    wall.two_sided = true;
    m.patches.push_back(wall);
  }
  m.patches.push_back({"fountain rim", revolved([](double v) -> Vec2 {
                         return {0.75 + 0.09 * std::sin(pi * v), 0.02 + 0.35 * v};
                       }),
                       28, 4, stone({0.5, 0.48, 0.44})});
  Patch water{"water", revolved([](double v) -> Vec2 {
                return {0.78 * (1 - v) + 1e-4, 0.3};
              }),
              20, 4, [](double, double, const Vec3&) -> Vec3 {
                return {0.03, 0.10, 0.12};
              }};
  water.reflectance = 0.06;
  water.sharpness = 10;
  m.patches.push_back(water);
  m.patches.push_back({"column", revolved([](double v) -> Vec2 {
                         return {0.12 + 0.03 * std::cos(2 * pi * v), 0.3 + 0.8 * v};
                       }),
                       14, 8, stone({0.55, 0.53, 0.48})});
  m.patches.push_back({"ball", revolved([](double v) -> Vec2 {
                         return {0.2 * std::sin(pi * v) + 1e-4, 1.28 - 0.2 * std::cos(pi * v)};
                       }),
                       16, 10, stone({0.6, 0.3, 0.2})});
  // The backdrop is emissive: hills, haze and sky.
  Patch sky{"backdrop",
            [](double u, double v) -> Vec3 {
              const double e = -0.05 + 1.25 * v;
              return 15.8 * Vec3(std::cos(2 * pi * u) * std::cos(e), std::sin(e), std::sin(2 * pi * u) * std::cos(e));
            },
            40, 10,
            [](double u, double v, const Vec3& p) -> Vec3 {
              const double hill = 0.14 + 0.06 * std::sin(2 * pi * u * 3) + 0.04 * std::sin(2 * pi * u * 7 + 1);
              if (v < hill) return Vec3(0.12, 0.2, 0.1) * (0.8 + 0.4 * noise(p));
              return Vec3(0.35, 0.55, 0.9) * (0.6 + 0.5 * v) + Vec3(0.5, 0.4, 0.3) * std::exp(-(v - hill) * 7);
            }};
  m.patches.push_back(sky);
  m.sun = {0.6, 1, 0.3};
  m.camera = [](double s, double t) {
    Camera camera;
    const double a = 2 * pi * s;
    camera.eye = Vec3(2.3 * std::sin(a), 0.7 + 0.7 * t, 2.3 * std::cos(a));
    camera.target = {0.3 * std::sin(5 * a), 0.65, 0};
    camera.fov_degrees = 47;
    camera.near_plane = 0.2;
    camera.far_plane = 60;
    return camera;
  };
  return m;
}

}  // namespace rebake::bakery
