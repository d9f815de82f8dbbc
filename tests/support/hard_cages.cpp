#include "tests/support/hard_cages.h"
#include "tests/support/thorough.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace rebake::test {

Cage cube(int cells) {
  const double half = 0.5 / std::sqrt(3.0);
  return lattice_cage(Box(Vec3::Constant(-half), Vec3::Constant(half)), cells, cells, cells);
}

Cage dented() {
  Cage cage = cube(3);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> shift(-0.06, 0.06);
  for (Vec3& v : cage.vertices) {
    // In this order: the order in which a call's arguments are evaluated is unspecified.
    const double z = shift(random), y = shift(random), x = shift(random);
    v = v.normalized() * 0.4 + Vec3(x, y, z);
    if (v.x() > 0.2) v.x() = 0.35 - v.x();
  }
  return checked_cage(cage);
}

Cage needles(double thin) {
  Cage cage;
  cage.vertices = {{0, 0, 0}, {0.6, 0, 0}, {0, 0.6, 0}, {0, 0, 0.6}, {0.25, thin, 0}};
  cage.faces = {{0, 3, 2}, {1, 2, 3}, {0, 1, 3}, {0, 4, 1}, {1, 4, 2}, {2, 4, 0}};
  return checked_cage(cage);
}

Cage cap(double lift) {
  Cage cage;
  cage.vertices = {{0, 0, 0}, {0.5, 0, 0}, {0, 0.5, 0}, {0, 0, 0.5}, {0.25, 0, lift}};
  cage.faces = {{0, 2, 4}, {4, 2, 1}, {0, 4, 3}, {4, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return checked_cage(cage);
}

Cage flat(double thickness) {
  return lattice_cage(Box(Vec3(-0.35, -0.35, -thickness / 2), Vec3(0.35, 0.35, thickness / 2)), 2, 2, 1);
}

Cage scaled(Cage cage, double scale, const Vec3& offset) {
  for (Vec3& v : cage.vertices) v = v * scale + offset;
  return cage;
}

std::vector<std::pair<std::string, Cage>> hard_cages() {
  std::vector<std::pair<std::string, Cage>> cages = {{"cube", cube()}, {"lattice", cube(2)}, {"dented", dented()}};
  for (const double thin : {1e-3, 1e-6, 1e-9, 1e-12})
    cages.emplace_back("needles " + std::to_string(thin), needles(thin));
  cages.emplace_back("cap 1e-12", cap(1e-12));
  cages.emplace_back("cap of no area", cap(0));
  Cage doubled = needles(0.1);
  doubled.vertices[4] = doubled.vertices[0];
  cages.emplace_back("doubled point", doubled);
  Cage floater = cube();
  const Cage other = scaled(cube(), 0.1, Vec3(0.5, 0.1, 0));
  for (const Face& face : other.faces) floater.faces.push_back({face[0] + 8, face[1] + 8, face[2] + 8});
  floater.vertices.insert(floater.vertices.end(), other.vertices.begin(), other.vertices.end());
  cages.emplace_back("two components", floater);
  return cages;
}

namespace {

std::vector<Vec3> all_hard_points(const Cage& cage) {
  std::vector<Vec3> points;
  std::mt19937 random(11);
  std::uniform_real_distribution<double> any(0.05, 0.9);
  for (const Face& face : cage.faces) {
    const Vec3 &a = cage.vertices[face[0]], &b = cage.vertices[face[1]], &c = cage.vertices[face[2]];
    const Vec3 normal = (b - a).cross(c - a).stableNormalized();
    if (!normal.allFinite()) continue;
    const double s = any(random), t = any(random) * (1 - s);
    const std::vector<Vec3> places = {(a + b + c) / 3, a + s * (b - a) + t * (c - a), (a + b) / 2, a + s * (b - a), a};
    for (const double d : {0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3, 1e-1})
      for (const Vec3& place : places) {
        points.push_back(place - d * normal);
        points.push_back(place + d * normal);
        points.push_back(place + d * Vec3(0.3, -0.5, 0.8));
      }
    // In the plane outside the face, on an edge's extension, and just above an edge's extension.
    for (const double d : {1e-12, 1e-6, 0.3}) {
      points.push_back(a + (a - b) * d + (a - c) * d);
      points.push_back(a + (a - b) * d);
      points.push_back(b + (b - c) * d + 1e-12 * normal);
    }
  }
  return points;
}

}  // namespace

std::vector<Vec3> hard_points(const Cage& cage) {
  const std::vector<Vec3> points = all_hard_points(cage);
  std::vector<Vec3> some;
  // A prime, so that all kinds of points at all distances are included; sanitizers see some of them.
  const auto step = static_cast<std::size_t>(cases(11, 1, 53));
  for (std::size_t k = 0; k < points.size(); k += step) some.push_back(points[k]);
  return some;
}

std::vector<Vec3> inside_points(const Cage& cage) {
  std::vector<Vec3> points;
  for (const Vec3& p : all_hard_points(cage)) {
    double sum = 0;
    for (const Face& face : cage.faces) {
      const Vec3 a = cage.vertices[face[0]] - p, b = cage.vertices[face[1]] - p, c = cage.vertices[face[2]] - p;
      sum += 2 * std::atan2(a.dot(b.cross(c)), a.norm() * b.norm() * c.norm() + a.dot(b) * c.norm() +
                                                   b.dot(c) * a.norm() + c.dot(a) * b.norm());
    }
    if (std::abs(sum / (4 * std::acos(-1.0)) - 1) < 1e-3) points.push_back(p);
  }
  EXPECT_GE(points.size(), 20U);
  const auto step = static_cast<std::size_t>(points.size() > 1000 ? cases(5, 1, 23) : 1);
  std::vector<Vec3> some;
  for (std::size_t k = 0; k < points.size(); k += step) some.push_back(points[k]);
  return some;
}

}  // namespace rebake::test
