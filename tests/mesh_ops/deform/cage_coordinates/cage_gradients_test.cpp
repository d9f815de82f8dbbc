// Gradients of cage coordinates compared with 120-digit arithmetic: near faces, and one-sided limits on faces, edges
// and vertices.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <tuple>
#include <utility>

#include "mesh_ops/deform/cage_coordinates/cage_deformation.h"
#include "mesh_ops/deform/cage_coordinates/coordinates.h"
#include "tests/support/coordinate_errors.h"
#include "tests/support/gold.h"
#include "tests/support/hard_cages.h"

namespace rebake::test {
namespace {

// Jacobian of the deformation that moves each row of the coordinates (cage vertex, or face for ψ) by its motion.
Mat3 jacobian_of(const std::vector<Vec3>& gradients, const std::vector<Vec3>& motions) {
  Mat3 jacobian = Mat3::Identity();
  for (std::size_t row = 0; row < gradients.size(); ++row) jacobian += motions[row] * gradients[row].transpose();
  return jacobian;
}

std::vector<Vec3> any_motions(std::size_t rows) {
  std::vector<Vec3> motions;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-0.3, 0.3);
  for (std::size_t row = 0; row < rows; ++row) motions.emplace_back(any(random), any(random), any(random));
  return motions;
}

void expect_gradients(const Cage& cage, const Coordinates& coordinates,
                      std::vector<Gold> (*exact)(const Cage&, const Gold3&), double unit, bool corners) {
  const std::vector<Vec3> motions = any_motions(coordinates.rows());
  std::vector<Vec3> in_cage_units = motions;
  for (std::size_t row = cage.vertices.size(); row < motions.size(); ++row) in_cage_units[row] *= unit;
  for (const auto& [distance, bar] :
       {std::pair(1e-1, 1e-12), std::pair(1e-3, 1e-11), std::pair(1e-6, 1e-8), std::pair(1e-9, 1e-5)})
    for (std::size_t f = 0; f < cage.faces.size(); f += 17) {
      const Face& face = cage.faces[f];
      const Vec3 &a = cage.vertices[face[0]], &b = cage.vertices[face[1]], &c = cage.vertices[face[2]];
      const Vec3 inwards = -(b - a).cross(c - a).normalized();
      const std::vector<Vec3> places = {(a + b + c) / 3, (a + b) / 2 + 0.3 * distance * (c - a), a};
      for (const Vec3& place : places) {
        const Vec3 point = place + distance * inwards;
        // Near edges and corners the point may lie on another face, where Green's coordinates have no gradient.
        if (!corners && &place != &places.front()) continue;
        std::vector<Vec3> gradients;
        weights_at(coordinates, point, &gradients);
        const Mat3 got = jacobian_of(gradients, motions),
                   want = jacobian_of(gold_gradients(exact, cage, point), in_cage_units);
        EXPECT_LE((got - want).norm(), bar * std::max(1.0, want.norm())) << "at " << distance << " from face " << f;
      }
    }
}

TEST(MeanValue, JacobiansAgreeWith120Digits) {
  const Cage cage = dented();
  expect_gradients(cage, *mean_value_coordinates(cage), gold_mean_value, 1, true);
  // Also in the planes of other faces, whose contribution vanishes there.
  const Cage lattice = cube(2);
  const auto coordinates = mean_value_coordinates(lattice);
  const Vec3 point(0, 0, 0.1);
  std::vector<Vec3> gradients;
  weights_at(*coordinates, point, &gradients);
  const std::vector<Vec3> exact = gold_gradients(gold_mean_value, lattice, point);
  for (std::size_t v = 0; v < exact.size(); ++v) EXPECT_LE((exact[v] - gradients[v]).norm(), 1e-13);
}

TEST(Green, JacobiansAgreeWith120Digits) {
  const Cage cage = dented();
  expect_gradients(cage, *green_coordinates(cage), gold_green, frame_of(cage).scale, false);
}

// One-sided limit of the gradient from inside: central differences with step 1e-40, at a depth of 1e-25.
std::vector<Vec3> one_sided(std::vector<Gold> (*exact)(const Cage&, const Gold3&), const Cage& cage,
                            const std::array<Vec3, 3>& from, const std::array<int, 3>& parts, const Vec3& inwards) {
  // The base point lies exactly on the surface: (Σ partsₖ fromₖ) / Σ partsₖ.
  const Gold step("1e-40"), depth("1e-25");
  const Gold whole = parts[0] + parts[1] + parts[2];
  Gold3 at;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    at[axis] = depth * Gold(inwards[static_cast<int>(axis)]);
    for (std::size_t k = 0; k < 3; ++k) at[axis] += Gold(from[k][static_cast<int>(axis)]) * parts[k] / whole;
  }
  std::vector<Vec3> result;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Gold3 low = at, high = at;
    low[axis] -= step;
    high[axis] += step;
    const std::vector<Gold> below = exact(cage, low), above = exact(cage, high);
    result.resize(below.size());
    for (std::size_t i = 0; i < below.size(); ++i)
      result[i][static_cast<int>(axis)] = static_cast<double>((above[i] - below[i]) / (2 * step));
  }
  return result;
}

void expect_one_sided_limits(const Cage& cage, const Coordinates& coordinates,
                             std::vector<Gold> (*exact)(const Cage&, const Gold3&), bool faces_only) {
  const std::vector<Vec3> motions = any_motions(coordinates.rows());
  std::vector<Vec3> in_cage_units = motions;
  for (std::size_t row = cage.vertices.size(); row < motions.size(); ++row) in_cage_units[row] *= frame_of(cage).scale;
  const std::array<std::array<int, 3>, 5> faces{{{1, 1, 1}, {2, 1, 5}, {1, 7, 8}, {40, 1, 23}, {3, 60, 1}}};
  const std::array<std::array<int, 3>, 6> all{{{1, 1, 1}, {2, 1, 5}, {1, 1, 0}, {0, 3, 5}, {1, 0, 0}, {0, 0, 1}}};
  double worst = 0;
  for (std::size_t f = 0; f<cage.faces.size(); f += cage.faces.size()> 20 ? 19 : 1) {
    const Face& face = cage.faces[f];
    const std::array<Vec3, 3> corners{cage.vertices[face[0]], cage.vertices[face[1]], cage.vertices[face[2]]};
    const auto look = [&](const std::array<int, 3>& parts) {
      const double whole = parts[0] + parts[1] + parts[2];
      const Vec3 point = (parts[0] * corners[0] + parts[1] * corners[1] + parts[2] * corners[2]) / whole;
      // Outward normal at the point: mean over all faces that contain it, weighted by their angles there.
      Vec3 outwards(0, 0, 0);
      for (const Face& other : cage.faces) {
        const Vec3 &a = cage.vertices[other[0]], &b = cage.vertices[other[1]], &c = cage.vertices[other[2]];
        const Vec3 normal = (b - a).cross(c - a).normalized();
        const Vec3 area((b - point).cross(c - point).dot(normal), (c - point).cross(a - point).dot(normal),
                        (a - point).cross(b - point).dot(normal));
        if (std::abs(normal.dot(point - a)) > 1e-14 || area.minCoeff() < -1e-14) continue;
        double angle = 1;
        for (std::size_t k = 0; k < 3; ++k)
          if ((cage.vertices[other[k]] - point).norm() < 1e-14) {
            const Vec3 u = cage.vertices[other[(k + 1) % 3]] - point, v = cage.vertices[other[(k + 2) % 3]] - point;
            angle = std::atan2(u.cross(v).norm(), u.dot(v));
          }
        outwards += angle * normal;
      }
      std::vector<Vec3> gradients;
      weights_at(coordinates, point, &gradients);
      const Mat3 got = jacobian_of(gradients, motions),
                 want = jacobian_of(one_sided(exact, cage, corners, parts, -outwards.normalized()), in_cage_units);
      const double error = (got - want).norm() / std::max(1.0, want.norm());
      EXPECT_LE(error, 1e-8) << "face " << f << " at " << parts[0] << ' ' << parts[1] << ' ' << parts[2];
      worst = std::max(worst, error);
    };
    if (faces_only)
      for (const auto& parts : faces) look(parts);
    else
      for (const auto& parts : all) look(parts);
  }
  testing::Test::RecordProperty("worst", std::to_string(worst));
}

// Points of a bounding-box cage lie on its faces, edges and corners. A gradient of 0 there would rotate them by 180°.
TEST(MeanValue, JacobiansOnTheSurfaceAreLimitsFromInside) {
  for (const Cage& cage : {cube(), dented(), needles(1e-3)})
    expect_one_sided_limits(cage, *mean_value_coordinates(cage), gold_mean_value, false);
}

TEST(Green, JacobiansOnFacesAreLimitsFromInside) {
  for (const Cage& cage : {cube(), dented()}) expect_one_sided_limits(cage, *green_coordinates(cage), gold_green, true);
}

TEST(MeanValue, JacobiansOnEdgeExtensionsAgreeWith120Digits) {
  const Cage cage = cube();
  const double h = cage.vertices[1].cwiseAbs().maxCoeff();
  const auto coordinates = mean_value_coordinates(cage);
  std::vector<Vec3> points{{0.38867513459481295, -h, -h}, {h, -0.25868045533410799, -0.18867513459481292}};
  for (const double aside : {0.0, 1e-17, 1e-15, 1e-13, 1e-11, 1e-9, 1e-7, 1e-5, 1e-4, 1e-3, 1e-2})
    for (const double along : {0.02, 0.1, 0.6})
      for (const Vec3& direction : {Vec3(0, 1, 0), Vec3(0, 0, -1), Vec3(0, 0.3, 0.4), Vec3(0, -0.5, 0.2)})
        points.push_back(Vec3(h + along, -h, -h) + aside * direction);
  for (const Vec3& point : points) {
    std::vector<Vec3> gradients;
    weights_at(*coordinates, point, &gradients);
    std::vector<Vec3> exact = gold_gradients(gold_mean_value, cage, point);
    if (point.x() == h) {  // on a face: limit from inside
      Gold3 at = gold(point);
      at[0] -= Gold("1e-30");
      exact.clear();
      for (std::size_t axis = 0; axis < 3; ++axis) {
        Gold3 low = at, high = at;
        low[axis] -= Gold("1e-45");
        high[axis] += Gold("1e-45");
        const auto below = gold_mean_value(cage, low), above = gold_mean_value(cage, high);
        exact.resize(below.size());
        for (std::size_t v = 0; v < below.size(); ++v)
          exact[v][static_cast<int>(axis)] = static_cast<double>((above[v] - below[v]) / Gold("2e-45"));
      }
    }
    for (std::size_t v = 0; v < exact.size(); ++v)
      EXPECT_LE((exact[v] - gradients[v]).norm(), 1e-8) << "at " << point.transpose() << " weight " << v;
  }
}

Cage joined(const Cage& a, const Cage& b) {
  Cage both = a;
  const auto first = static_cast<std::uint32_t>(a.vertices.size());
  both.vertices.insert(both.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const Face& face : b.faces) both.faces.push_back({face[0] + first, face[1] + first, face[2] + first});
  return both;
}

// With equal vertices merged.
Cage merged(const Cage& cage) {
  Cage result;
  std::vector<std::uint32_t> number;
  for (const Vec3& v : cage.vertices) {
    const auto found = std::find(result.vertices.begin(), result.vertices.end(), v);
    number.push_back(static_cast<std::uint32_t>(found - result.vertices.begin()));
    if (found == result.vertices.end()) result.vertices.push_back(v);
  }
  for (const Face& face : cage.faces) result.faces.push_back({number[face[0]], number[face[1]], number[face[2]]});
  return result;
}

// A pyramid with its tip at the origin over an octagon with a notch. The mean direction of the tip's faces is outside.
Cage notched_pyramid() {
  const std::vector<Vec3> base{{-1, -1, 1},    {1, -1, 1},  {1, -0.4, 1}, {-0.6, -0.4, 1},
                               {-0.6, 0.4, 1}, {1, 0.4, 1}, {1, 1, 1},    {-1, 1, 1}};
  Cage cage{base, {}};
  cage.vertices.emplace_back(0, 0, 0);
  for (std::uint32_t k = 0; k < 8; ++k) cage.faces.push_back({(k + 1) % 8, k, 8});
  for (const Face& face : {Face{0, 1, 2}, Face{0, 2, 3}, Face{0, 3, 4}, Face{0, 4, 7}, Face{4, 5, 6}, Face{4, 6, 7}})
    cage.faces.push_back(face);
  return checked_cage(cage);
}

// Where parts of a cage touch, and at tips of which the mean direction is outside, there is no plain normal. Any limit
// from inside is right, and all agree if the cage moves rigidly.
TEST(CageCoordinates, GradientsAreThoseFromInsideWherePartsTouch) {
  const auto box = [](const Vec3& from, const Vec3& to) { return lattice_cage(Box(from, to), 1, 1, 1); };
  const Cage unit = box(Vec3(0, 0, 0), Vec3(1, 1, 1)), beyond = box(Vec3(1, 1, 1), Vec3(2, 2, 2));
  const Vec3 tip(1, 1, 1);
  const std::vector<std::tuple<std::string, Cage, std::vector<Vec3>>> cages = {
      {"one vertex", merged(joined(unit, beyond)), {tip}},
      {"equal vertices", joined(unit, beyond), {tip}},
      {"along an edge", joined(unit, box(Vec3(1, 1, 0), Vec3(2, 2, 1))), {Vec3(1, 1, 0.3), Vec3(1, 1, 1)}},
      {"boxes of other shapes", joined(unit, box(Vec3(1, 1, 1), Vec3(1.3, 1.5, 1.7))), {tip}},
      {"notched pyramid", notched_pyramid(), {Vec3(0, 0, 0)}},
  };
  for (const auto& [name, cage, points] : cages)
    for (const double scale : {1.0, 1e-8})
      for (const double turn : {0.0, 0.3}) {
        const Mat3 placed = scale * Eigen::AngleAxisd(turn, Vec3(3, -1, 2).normalized()).matrix();
        const Mat3 rotation = Eigen::AngleAxisd(1, Vec3(0, 0, 1)).matrix();
        Cage at = cage;
        for (Vec3& v : at.vertices) v = placed * v;
        std::vector<Vec3> moved;
        for (const Vec3& v : at.vertices) moved.push_back(rotation * v);
        // At the point, and within rounding of it.
        std::vector<Vec3> places;
        for (const Vec3& p : points)
          for (const double off : {0.0, 1e-16, -1e-16}) places.push_back(placed * (p + Vec3(off, 2 * off, -off)));
        for (const CageCoordinates kind : {CageCoordinates::mean_value, CageCoordinates::green}) {
          const DeformedPoints result = deform_points(*coordinates_of(at, kind, 0), at, moved, places, true);
          for (std::size_t k = 0; k < places.size(); ++k) {
            EXPECT_EQ(result.outside[k], 0) << name;
            EXPECT_LE((result.jacobians[k] - rotation).norm(), 1e-9)
                << name << ", point " << k << ", scale " << scale << ", turned by " << turn << ", "
                << static_cast<int>(kind) << '\n'
                << result.jacobians[k];
          }
        }
      }
}

}  // namespace
}  // namespace rebake::test
