#include "samples/bakery/surface.h"

#include <cmath>
#include <cstdint>
#include <numbers>

namespace rebake::bakery {

using std::numbers::pi;

std::function<Vec3(double, double)> revolved(std::function<Vec2(double)> profile, const Vec3& centre) {
  return [profile = std::move(profile), centre](double u, double v) -> Vec3 {
    const Vec2 p = profile(v);
    // Clockwise, so that the normal points out while v runs up.
    return centre + Vec3(p.x() * std::cos(2 * pi * u), p.y(), -p.x() * std::sin(2 * pi * u));
  };
}

std::function<Vec3(double, double)> tube(std::function<Vec3(double)> curve, std::function<double(double)> radius) {
  return [curve = std::move(curve), radius = std::move(radius)](double u, double v) -> Vec3 {
    const double step = 1e-3;
    const Vec3 along = (curve(v + step) - curve(v - step)).normalized();
    const Vec3 side = along.cross(std::abs(along.z()) < 0.9 ? Vec3::UnitZ() : Vec3::UnitX()).normalized();
    const Vec3 other = along.cross(side);
    return curve(v) + radius(v) * (std::cos(2 * pi * u) * side + std::sin(2 * pi * u) * other);
  };
}

std::function<Vec3(double, double)> plane(const Vec3& corner, const Vec3& along_u, const Vec3& along_v) {
  return [=](double u, double v) -> Vec3 { return corner + u * along_u + v * along_v; };
}

double noise(const Vec3& p) {
  const auto hash = [](int x, int y, int z) {
    std::uint32_t h = static_cast<std::uint32_t>(x) * 374761393U + static_cast<std::uint32_t>(y) * 668265263U +
                      static_cast<std::uint32_t>(z) * 2147483647U;
    h = (h ^ (h >> 13)) * 1274126177U;
    return static_cast<double>((h ^ (h >> 16)) & 0xffffffU) / 0xffffff;
  };
  const Vec3 cell = p.array().floor(), f = p - cell;
  const Vec3 s = f.array().square() * (3 - 2 * f.array());
  const int x = static_cast<int>(cell.x()), y = static_cast<int>(cell.y()), z = static_cast<int>(cell.z());
  double sum = 0;
  for (int k = 0; k < 8; ++k)
    sum += hash(x + (k & 1), y + (k >> 1 & 1), z + (k >> 2)) * (k & 1 ? s.x() : 1 - s.x()) *
           (k >> 1 & 1 ? s.y() : 1 - s.y()) * (k >> 2 ? s.z() : 1 - s.z());
  return sum;
}

Model warped(const Model& model, const std::function<Vec3(std::size_t, const Vec3&)>& warp) {
  Model result = model;
  for (std::size_t k = 0; k < result.patches.size(); ++k) {
    Patch& patch = result.patches[k];
    const auto point = patch.point;
    const auto albedo = patch.albedo;
    patch.point = [=](double u, double v) -> Vec3 { return warp(k, point(u, v)); };
    patch.albedo = [=](double u, double v, const Vec3&) -> Vec3 { return albedo(u, v, point(u, v)); };
  }
  return result;
}

std::function<Camera(double, double)> orbit_cameras(const Vec3& target, double distance, double lowest,
                                                    double highest) {
  return [=](double s, double t) {
    const double elevation = (lowest + (highest - lowest) * t) * pi / 180, azimuth = 2 * pi * s;
    Camera camera;
    camera.target = target;
    camera.eye = target + distance * Vec3(std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
                                          std::cos(elevation) * std::cos(azimuth));
    camera.near_plane = distance * 0.2;
    camera.far_plane = distance * 3;
    return camera;
  };
}

}  // namespace rebake::bakery
