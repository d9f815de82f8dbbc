#include <cmath>
#include <numbers>

#include "samples/bakery/surface.h"

// A potted plant: pot, soil, trunk, one long bendable branch to the right, and leaves cut out by opacity.

namespace rebake::bakery {

using std::numbers::pi;

namespace {

Vec3 trunk_at(double v) { return {0.06 * std::sin(2.5 * v), -0.38 + 1.0 * v, 0.05 * std::sin(4 * v)}; }
Vec3 branch_at(double v) {
  return trunk_at(0.55) + Vec3(0.95 * v, 0.35 * v + 0.12 * std::sin(3 * v), 0.08 * std::sin(5 * v));
}
Vec3 short_branch_at(double v) { return trunk_at(0.72) + Vec3(-0.55 * v, 0.35 * v, 0.12 * v); }

Patch leaf(const std::string& name, const Vec3& root, const Vec3& along, double length, double tone) {
  const Vec3 axis = along.normalized();
  const Vec3 side =
      (axis.cross(Vec3::UnitY()).norm() > 0.1 ? axis.cross(Vec3::UnitY()) : axis.cross(Vec3::UnitX())).normalized();
  const Vec3 up = side.cross(axis);
  Patch p;
  p.name = name;
  p.columns = 2;
  p.rows = 3;
  p.two_sided = true;
  p.point = [=](double u, double v) -> Vec3 {
    const double x = u - 0.5;
    return root + axis * (length * v) + side * (0.62 * length * x) + up * (length * (0.35 * x * x - 0.22 * v * v));
  };
  p.opaque = [](double u, double v) {
    return std::abs(u - 0.5) < 0.5 * std::pow(std::sin(pi * std::pow(v, 0.8)), 0.8) * (1 - 0.35 * v) ||
           (std::abs(u - 0.5) < 0.04 && v < 0.1);
  };
  p.albedo = [tone](double u, double v, const Vec3&) -> Vec3 {
    const double vein = std::exp(-std::pow((u - 0.5) / 0.035, 2)) +
                        0.45 * std::exp(-std::pow((std::fmod(v * 6 + std::abs(u - 0.5) * 4, 1.0) - 0.5) / 0.1, 2));
    return Vec3(0.06 + 0.06 * tone, 0.24 + 0.12 * tone, 0.05) * (1 + 0.7 * std::min(vein, 1.0));
  };
  p.reflectance = 0.03;
  p.sharpness = 12;
  return p;
}

}  // namespace

Model ficus() {
  Model m;
  m.name = "ficus";
  const auto clay = [](double, double v, const Vec3& p) -> Vec3 {
    const double band = v > 0.72 && v < 0.86 ? 0.75 : 1;
    return Vec3(0.56, 0.24, 0.13) * band * (0.8 + 0.4 * noise(p * 14));
  };
  m.patches.push_back({"pot", revolved([](double v) -> Vec2 {
                         const double rim = v > 0.86 ? 0.035 : 0;
                         return {0.24 + 0.13 * std::min(v, 0.9) + rim, -0.95 + 0.6 * v};
                       }),
                       28, 8, clay});
  m.patches.push_back({"pot inside", revolved([](double v) -> Vec2 {
                         return {0.385 - 0.02 * v, -0.35 - 0.12 * v};
                       }),
                       28, 2, clay});
  m.patches.push_back(
      {"soil", revolved([](double v) -> Vec2 {
         return {0.37 * (1 - v) + 1e-4, -0.43 + 0.03 * std::sin(pi * v)};
       }),
       16, 4, [](double, double, const Vec3& p) -> Vec3 { return Vec3(0.10, 0.07, 0.05) * (0.5 + noise(p * 30)); }});
  const auto bark = [](double u, double v, const Vec3& p) -> Vec3 {
    return Vec3(0.30, 0.22, 0.15) * (0.6 + 0.8 * noise(Vec3(u * 9, v * 24, p.y() * 3)));
  };
  m.patches.push_back({"trunk", tube(trunk_at, [](double v) { return 0.05 - 0.025 * v; }), 8, 14, bark});
  m.patches.push_back({"branch", tube(branch_at, [](double v) { return 0.03 - 0.018 * v; }), 8, 16, bark});
  m.patches.push_back({"short branch", tube(short_branch_at, [](double v) { return 0.025 - 0.014 * v; }), 8, 8, bark});

  int count = 0;
  const auto leaves_along = [&](const std::function<Vec3(double)>& curve, double from, double to, int leaves,
                                double length) {
    for (int i = 0; i < leaves; ++i, ++count) {
      const double v = from + (to - from) * i / (leaves - 1), turn = 2.4 * count;
      const Vec3 along = (curve(v + 0.01) - curve(v - 0.01)).normalized();
      const Vec3 side = along.cross(std::abs(along.y()) < 0.9 ? Vec3::UnitY() : Vec3::UnitX()).normalized(),
                 other = along.cross(side);
      const Vec3 out = std::cos(turn) * side + std::sin(turn) * other + 0.35 * along + 0.15 * Vec3::UnitY();
      m.patches.push_back(leaf("leaf " + std::to_string(count), curve(v), out,
                               length * (0.85 + 0.3 * noise(Vec3(count * 1.7, 3.1, 0.2))),
                               noise(Vec3(count * 3.3, 1, 1))));
    }
  };
  leaves_along(trunk_at, 0.62, 1.0, 34, 0.30);
  leaves_along(branch_at, 0.25, 1.0, 32, 0.27);
  leaves_along(short_branch_at, 0.3, 1.0, 20, 0.27);
  m.camera = orbit_cameras({0.12, -0.1, 0}, 3.6, 5, 70);
  return m;
}

}  // namespace rebake::bakery
