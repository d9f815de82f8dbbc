// Cage coordinates at random points at distances of 1e-16 … 1e-6 from faces, edges and corners of random wedges,
// lattices and stars. Sums of weights hide most errors, so linear precision is tested and weights are compared with
// 120-digit arithmetic.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <tuple>

#include "mesh_ops/deform/cage_coordinates/coordinates.h"
#include "tests/support/gold.h"
#include "tests/support/hard_cages.h"
#include "tests/support/random_cages.h"
#include "tests/support/thorough.h"

namespace rebake::test {
namespace {

struct Weighed {
  std::vector<double> weights;
  std::vector<Vec3> gradients;
  bool outside;
};

std::vector<Weighed> weighed(const Coordinates& coordinates, const std::vector<Vec3>& points) {
  std::vector<Weighed> result(points.size());
  const std::size_t rows = coordinates.rows();
  std::vector<double> weights(rows * batch_lanes), with_gradients(weights.size()), slopes(rows * 3 * batch_lanes);
  for (std::size_t first = 0; first < points.size(); first += batch_lanes) {
    std::array<Vec3, batch_lanes> block;
    for (std::size_t lane = 0; lane < batch_lanes; ++lane)
      block[lane] = points[std::min(first + lane, points.size() - 1)];
    std::array<std::uint8_t, batch_lanes> outside, outside_too;
    coordinates.compute_weights(block, weights.data(), nullptr, outside.data());
    coordinates.compute_weights(block, with_gradients.data(), slopes.data(), outside_too.data());
    for (std::size_t lane = 0; lane < batch_lanes && first + lane < points.size(); ++lane) {
      Weighed& one = result[first + lane];
      one.outside = outside[lane] != 0;
      EXPECT_EQ(outside[lane], outside_too[lane]) << "inside or outside must not depend on the request for gradients";
      for (std::size_t row = 0; row < rows; ++row) {
        one.weights.push_back(weights[row * batch_lanes + lane]);
        const double* slope = slopes.data() + row * 3 * batch_lanes + lane;
        one.gradients.emplace_back(slope[0], slope[batch_lanes], slope[2 * batch_lanes]);
      }
    }
  }
  return result;
}

double diagonal_of(const Cage& cage) {
  Box box;
  for (const Vec3& v : cage.vertices) box.extend(v);
  return box.diagonal().norm();
}

// Errors of linear precision: Σ w v + Σ ψ n equals the point, and its gradient the identity. Relative to the sum of the
// absolute terms, in cage diagonals. They bound the error under rigid motions of the cage.
struct LinearErrors {
  double position = 0, jacobian = 0;
};
LinearErrors linear_errors(const Cage& cage, const Weighed& one, const Vec3& point) {
  const double size = diagonal_of(cage), scale = frame_of(cage).scale;
  Vec3 place(0, 0, 0);
  Mat3 jacobian = -Mat3::Identity();
  double sum = 1, gradient_sum = 1;
  for (std::size_t v = 0; v < cage.vertices.size(); ++v) {
    const Vec3 offset = cage.vertices[v] - point;
    place += one.weights[v] * offset;
    jacobian += offset * one.gradients[v].transpose();
    sum += std::abs(one.weights[v]);
    gradient_sum += one.gradients[v].norm() * size;
  }
  for (std::size_t row = cage.vertices.size(); row < one.weights.size(); ++row) {
    const Face& face = cage.faces[row - cage.vertices.size()];
    const Vec3 normal = (cage.vertices[face[1]] - cage.vertices[face[0]])
                            .cross(cage.vertices[face[2]] - cage.vertices[face[0]])
                            .normalized();
    place += one.weights[row] / scale * normal;
    jacobian += normal * one.gradients[row].transpose() / scale;
  }
  return {place.norm() / size / sum, jacobian.norm() / gradient_sum};
}

using Make = std::unique_ptr<Coordinates> (*)(const Cage&);
std::unique_ptr<Coordinates> make_mean_value(const Cage& cage) { return mean_value_coordinates(cage); }

struct Kind {
  RandomCage (*cage)(std::mt19937_64&);
  double position_bound;
};
// On wedges double precision allows 1e-16 / slope, and slopes are at least 1e-4.
const std::array<Kind, 3> kinds{Kind{random_wedge, 2e-13}, Kind{random_lattice, 2e-14}, Kind{random_star, 2e-14}};

void expect_linear_precision(Make make) {
  std::mt19937_64 random(1);
  constexpr int points_per_cage = 32;
  for (int k = 0; k < cases(30, 700, 9); ++k) {
    const Kind& kind = kinds[static_cast<std::size_t>(k) % kinds.size()];
    const auto [name, cage] = kind.cage(random);
    std::vector<Vec3> points;
    for (int n = 0; n < points_per_cage; ++n) points.push_back(random_near_point(cage, random));
    const std::vector<Weighed> all = weighed(*make(cage), points);
    for (std::size_t n = 0; n < points.size(); ++n) {
      if (all[n].outside) continue;
      const LinearErrors errors = linear_errors(cage, all[n], points[n]);
      EXPECT_LE(errors.position, kind.position_bound) << name << ", cage " << k << " at " << points[n].transpose();
      EXPECT_LE(errors.jacobian, 1e-8) << name << ", cage " << k << " at " << points[n].transpose();
    }
  }
}

TEST(CageProperty, MeanValueIsLinearlyPreciseNearRandomSurfaces) { expect_linear_precision(make_mean_value); }
TEST(CageProperty, GreenIsLinearlyPreciseNearRandomSurfaces) { expect_linear_precision(green_coordinates); }

// Allows rounding of 1e-14 relative to the largest weight, plus the effect of moving the point by 1e-15 diagonals.
void expect_agreement_with_120_digits(Make make, std::vector<Gold> (*exact)(const Cage&, const Gold3&)) {
  std::mt19937_64 random(2);
  int compared = 0;
  for (int k = 0; k < cases(60, 900, 21); ++k) {
    const auto [name, cage] = kinds[static_cast<std::size_t>(k) % kinds.size()].cage(random);
    const double size = diagonal_of(cage), scale = frame_of(cage).scale;
    std::vector<Vec3> points;
    for (int n = 0; n < cases(8, 34); ++n) points.push_back(random_near_point(cage, random));
    const std::vector<Weighed> all = weighed(*make(cage), points);
    for (std::size_t n = 0; n < points.size(); ++n) {
      const std::vector<Gold> want = exact(cage, gold(points[n]));
      Gold sum = 0;
      for (std::size_t v = 0; v < cage.vertices.size(); ++v) sum += want[v];
      // Outside and exactly on the surface, the reference for Green's coordinates does not sum to 1 or is NaN.
      if (all[n].outside || !(abs(sum - 1) <= 1e-9)) continue;
      ++compared;
      double largest = 1;
      for (const Gold& weight : want) largest = std::max(largest, std::abs(static_cast<double>(weight)));
      std::vector<Vec3> slopes;
      for (std::size_t row = 0; row < want.size(); ++row) {
        const double unit = row < cage.vertices.size() ? 1 : scale;
        double error = std::abs(static_cast<double>(want[row] * unit - all[n].weights[row]));
        if (error > 1e-14 * largest) {
          if (slopes.empty()) slopes = gold_gradients(exact, cage, points[n]);
          error -= 1e-15 * size * slopes[row].norm() * unit;
        }
        EXPECT_LE(error, 1e-14 * largest) << name << ", row " << row << " at " << points[n].transpose();
      }
    }
  }
  EXPECT_GT(compared, is_sanitized ? 20 : 100);
}

TEST(CageProperty, MeanValueAgreesWith120DigitsNearRandomSurfaces) {
  expect_agreement_with_120_digits(make_mean_value, gold_mean_value);
}
TEST(CageProperty, GreenAgreesWith120DigitsNearRandomSurfaces) {
  expect_agreement_with_120_digits(green_coordinates, gold_green);
}

// Largest error of a mean value weight over all points, relative to the sum of the absolute exact weights there.
double largest_share(const Cage& cage, const std::vector<Vec3>& points) {
  double worst = 0;
  const std::vector<Weighed> all = weighed(*make_mean_value(cage), points);
  for (std::size_t n = 0; n < points.size(); ++n) {
    const std::vector<Gold> want = gold_mean_value(cage, gold(points[n]));
    Gold sum = 0, largest = 0;
    for (std::size_t v = 0; v < want.size(); ++v) {
      sum += abs(want[v]);
      largest = std::max(largest, Gold(abs(want[v] - all[n].weights[v])));
    }
    worst = std::max(worst, static_cast<double>(largest / sum));
  }
  return worst;
}

// largest_share() at random points outside, at 0.51 to 10 diagonals from the centre of the cage's box.
double far_error(const Cage& cage, std::mt19937_64& random, int count) {
  Box box;
  for (const Vec3& v : cage.vertices) box.extend(v);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> exponent(std::log(0.51), std::log(10.0));
  std::vector<Vec3> points;
  for (int n = 0; n < count; ++n)
    points.push_back(box.center() + diagonal_of(cage) * std::exp(exponent(random)) *
                                        Vec3(normal(random), normal(random), normal(random)).normalized());
  return largest_share(cage, points);
}

TEST(CageProperty, MeanValueHasThirteenDigitsUpToTenDiagonals) {
  std::mt19937_64 random(7);
  for (int k = 0; k < cases(10, 200, 10); ++k) {
    const RandomCage of = k % 2 == 0 ? random_lattice(random) : random_star(random);
    EXPECT_LE(far_error(of.cage, random, 24), 1e-13) << of.name;
  }
}

// largest_share() at random points at 1e-6 to 2 diagonals from a random surface point, in random directions.
double outside_error(const Cage& cage, std::mt19937_64& random, int count) {
  std::uniform_real_distribution<double> any(0, 1), exponent(std::log(1e-6), std::log(2.0));
  std::normal_distribution<double> normal;
  std::vector<Vec3> points;
  for (int n = 0; n < count; ++n) {
    const Face& face = cage.faces[random() % cage.faces.size()];
    double s = any(random), t = any(random);
    if (s + t > 1) s = 1 - s, t = 1 - t;
    points.push_back(cage.vertices[face[0]] * (1 - s - t) + cage.vertices[face[1]] * s + cage.vertices[face[2]] * t +
                     diagonal_of(cage) * std::exp(exponent(random)) *
                         Vec3(normal(random), normal(random), normal(random)).normalized());
  }
  return largest_share(cage, points);
}

// If terms cancel, faces are evaluated with 50 digits, except within 1e-6 of two faces if terms of other faces cancel.
TEST(CageProperty, MeanValueHasNineDigitsOutsideThinCages) {
  std::mt19937_64 random(8);
  const auto box = [](double x, double y, double z) {
    return lattice_cage(Box(Vec3(0, 0, 0), Vec3(x, y, z)), 1, 1, 1);
  };
  const auto wedge = [](double slope) {
    Cage cage;
    cage.vertices = {{0, 0, 0}, {1, 0, 0}, {0.5, 1, slope / 2}, {0.5, 1, -slope / 2}};
    cage.faces = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    return cage;
  };
  for (const double thin : {1e-1, 1e-2, 1e-4, 1e-6, 1e-8})
    for (const auto& [name, cage] :
         {std::pair("flat", box(1, 1, thin)), std::pair("rod", box(1, thin, thin)), std::pair("wedge", wedge(thin))}) {
      const double bound = std::max(1e-9, 5e-15 / thin);
      EXPECT_LE(outside_error(cage, random, cases(10, 100, 3)), bound) << name << ' ' << thin;
      EXPECT_LE(far_error(cage, random, cases(10, 50, 3)), 1e-9) << name << ' ' << thin << ", far";
    }
  for (int k = 0; k < cases(6, 150, 3); ++k) {
    const RandomCage of = random_wedge(random);
    EXPECT_LE(outside_error(of.cage, random, 10), 1e-9) << of.name;
  }
  // A weight of a rod's end, seen from beyond it: cancellation would give 18.07 instead of 0.94.
  EXPECT_NEAR(weighed(*make_mean_value(box(1, 1e-8, 1e-8)), {Vec3(2, 3e-9, 4e-9)}).front().weights[1], 0.942857, 1e-6);
}

// Both faces of a sharp edge contain this point in their plane, but outside the face.
TEST(CageProperty, PointBesideASharpEdgeFollowsTheCage) {
  Cage cage;
  cage.vertices = {{0, 0, 0}, {1, 0, -.2}, {1, 0, .2}, {0, 1, 0}};
  cage.faces = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
  const Vec3 point(-1e-15, 0.4, 0);
  const Weighed one = weighed(*mean_value_coordinates(cage), {point}).front();
  Vec3 place(0, 0, 0);
  for (std::size_t v = 0; v < 4; ++v) place += one.weights[v] * cage.vertices[v].cwiseProduct(Vec3(-1, -1, 1));
  EXPECT_LE((place - Vec3(1e-15, -0.4, 0)).norm(), 1e-15);
}

// Overlapping components have winding number 2: weights must be divided by it, or rotations are wrong.
TEST(CageProperty, GreenFollowsRotationsOfOverlappingComponents) {
  Cage cage = lattice_cage(Box(Vec3(0, 0, 0), Vec3(1, 1, 1)), 1, 1, 1);
  const Cage other = lattice_cage(Box(Vec3(0.5, 0.5, 0.5), Vec3(1.5, 1.5, 1.5)), 1, 1, 1);
  const auto base = static_cast<std::uint32_t>(cage.vertices.size());
  cage.vertices.insert(cage.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const Face& face : other.faces) cage.faces.push_back({face[0] + base, face[1] + base, face[2] + base});
  for (const Vec3& point : {Vec3(0.6, 0.7, 0.8), Vec3(0.2, 0.3, 0.1), Vec3(1.2, 1.1, 1.4)}) {
    const LinearErrors errors = linear_errors(cage, weighed(*green_coordinates(cage), {point}).front(), point);
    EXPECT_LE(errors.position, 1e-14) << point.transpose();
    EXPECT_LE(errors.jacobian, 1e-12) << point.transpose();
  }
}

// Each component is oriented on its own, also if others are wound differently.
TEST(CageProperty, OrientsEveryComponentOutwards) {
  const Cage box = lattice_cage(Box(Vec3(-1, -1, -1), Vec3(1, 1, 1)), 1, 1, 1);
  const auto joined = [&](const Vec3& offset, double scale, bool first_inwards, bool second_inwards) {
    Cage cage;
    for (const auto& [inwards, centre, size] :
         {std::tuple(first_inwards, Vec3(0, 0, 0), 1.0), std::tuple(second_inwards, offset, scale)}) {
      const auto base = static_cast<std::uint32_t>(cage.vertices.size());
      for (const Vec3& v : box.vertices) cage.vertices.push_back(centre + size * v);
      for (const Face& f : box.faces)
        cage.faces.push_back({f[0] + base, f[inwards ? 2 : 1] + base, f[inwards ? 1 : 2] + base});
    }
    return checked_cage(std::move(cage));
  };
  for (const bool first : {false, true})
    for (const bool second : {false, true}) {
      EXPECT_NEAR(volume(joined(Vec3(3, 0.2, 0), 0.5, first, second)), 9, 1e-12) << "side by side";
      EXPECT_NEAR(volume(joined(Vec3(2, 0, 0), 1, first, second)), 16, 1e-12) << "touching";
      EXPECT_NEAR(volume(joined(Vec3(0, 0, 0), 0.5, first, second)), first == second ? 9 : 7, 1e-12) << "a cavity";
    }
}

// One rounding outside a wall, the face and the cage must agree whether the point is inside. Far from the origin,
// roundings are larger.
TEST(CageProperty, GreenOneRoundingOutsideALattice) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> any(0, 1);
  for (const double place : {0.0, 1e3, -1e5, 1e7, -1e9, 1e12}) {
    const Cage cage = lattice_cage(Box(Vec3(place, place, place), Vec3(place + 1, place + 1, place + 1)), 6, 6, 6);
    std::vector<Vec3> points;
    for (int n = 0; n < 32; ++n) {
      for (int axis = 0; axis < 3; ++axis) {
        Vec3 point(place + any(random), place + any(random), place + any(random));
        const double outside = place == 0 ? -2.2e-16 : std::nextafter(place, -std::numeric_limits<double>::infinity());
        point[axis] = n % 2 == 0 ? outside : std::nextafter(place + 1, std::numeric_limits<double>::infinity());
        points.push_back(point);
      }
    }
    const std::vector<Weighed> all = weighed(*green_coordinates(cage), points);
    for (std::size_t n = 0; n < points.size(); ++n) {
      ASSERT_FALSE(all[n].outside) << "point " << n << " of the cage at " << place;
      const LinearErrors errors = linear_errors(cage, all[n], points[n]);
      EXPECT_LE(errors.position, std::max(1e-14, frame_of(cage).surface_tolerance)) << place;
      EXPECT_LE(errors.jacobian, 1e-8 + 16 * frame_of(cage).surface_tolerance) << place;
    }
  }
}

}  // namespace
}  // namespace rebake::test
