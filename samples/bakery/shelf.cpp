#include <cmath>
#include <numbers>

#include "samples/bakery/surface.h"

// A forward-facing scene: a bookshelf, seen along −z from a small range of eyes.

namespace rebake::bakery {

using std::numbers::pi;

Model shelf(bool with_vase) {
  Model m;
  m.name = with_vase ? "shelf" : "shelf_without_vase";
  m.axes = Axes::forward;
  const auto wood = [](double, double, const Vec3& p) -> Vec3 {
    return Vec3(0.42, 0.26, 0.13) * (0.7 + 0.5 * noise(Vec3(p.x() * 2, p.y() * 22, p.z() * 6)));
  };
  m.patches.push_back(
      {"back", plane({-1.6, -1.2, -2.6}, {3.2, 0, 0}, {0, 2.4, 0}), 14, 10,
       [](double, double, const Vec3& p) -> Vec3 { return Vec3(0.55, 0.52, 0.45) * (0.85 + 0.3 * noise(p * 5)); }});
  for (int k = 0; k < 3; ++k) {
    const double y = -1.1 + 0.85 * k;
    m.patches.push_back({"board " + std::to_string(k), plane({-1.5, y, -2.0}, {3, 0, 0}, {0, 0, -0.6}), 14, 3, wood});
    m.patches.push_back(
        {"edge " + std::to_string(k), plane({-1.5, y - 0.06, -2.0}, {3, 0, 0}, {0, 0.06, 0}), 14, 1, wood});
  }
  int count = 0;
  for (int row = 0; row < 2; ++row) {
    double x = -1.42;
    while (x < (row == 0 ? 1.2 : 0.45)) {
      const double width = 0.08 + 0.08 * noise(Vec3(count * 1.9, 0.3, 2)),
                   height = 0.5 + 0.2 * noise(Vec3(count * 2.7, 5, 1)), y = -1.1 + 0.85 * row,
                   z = -2.12 - 0.1 * noise(Vec3(count, 8.5, 3));
      const Vec3 color = Vec3(0.08 + 0.5 * noise(Vec3(count * 3.1, 1, 0)), 0.08 + 0.35 * noise(Vec3(count * 4.3, 2, 0)),
                              0.08 + 0.4 * noise(Vec3(count * 5.7, 3, 0)));
      const auto cover = [color](double u, double v, const Vec3&) -> Vec3 {
        return (v > 0.78 && v < 0.86) || (v > 0.12 && v < 0.16) ? Vec3(0.6, 0.5, 0.25)
                                                                : Vec3(color * (std::abs(u - 0.5) > 0.42 ? 0.7 : 1));
      };
      m.patches.push_back(
          {"book " + std::to_string(count), plane({x, y, z}, {width, 0, 0}, {0, height, 0}), 1, 4, cover});
      m.patches.push_back({"book top " + std::to_string(count), plane({x, y + height, z}, {width, 0, 0}, {0, 0, -0.35}),
                           1, 2, [](double, double, const Vec3&) -> Vec3 {
                             return {0.7, 0.66, 0.55};
                           }});
      m.patches.push_back({"book side " + std::to_string(count),
                           plane({x + width, y, z}, {0, 0, -0.35}, {0, height, 0}), 2, 4,
                           [color](double, double, const Vec3&) -> Vec3 { return color; }});
      x += width + 0.012;
      ++count;
    }
  }
  Patch vase{"vase",
             revolved(
                 [](double v) -> Vec2 {
                   return {0.09 + 0.13 * std::sin(pi * (0.15 + 0.75 * v)), 0.55 * v};
                 },
                 {0.95, -0.25, -2.25}),
             22, 8, [](double, double v, const Vec3&) -> Vec3 {
               return v > 0.4 && v < 0.5 ? Vec3(0.6, 0.45, 0.1) : Vec3(0.07, 0.28, 0.25);
             }};
  vase.reflectance = 0.06;
  vase.sharpness = 12;
  if (with_vase) m.patches.push_back(vase);
  m.sun = {-0.35, 0.7, 0.9};
  m.camera = [](double s, double t) {
    Camera camera;
    camera.eye = {-0.5 + s, -0.3 + 0.6 * t, 0.3};
    camera.target = {0.1, 0, -2.3};
    camera.fov_degrees = 50;
    camera.near_plane = 0.5;
    camera.far_plane = 25;
    return camera;
  };
  return m;
}

}  // namespace rebake::bakery
