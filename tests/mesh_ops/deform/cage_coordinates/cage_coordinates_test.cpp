// Cage coordinates compared with 120-digit arithmetic in hard cases: points on, near and beyond faces, edges and
// vertices; needles, caps and flat cages; very small, very large and very distant cages.
#include "mesh_ops/deform/cage_coordinates/coordinates.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <utility>

#include "mesh_ops/deform/cage_coordinates/cage_deformation.h"
#include "tests/support/coordinate_errors.h"
#include "tests/support/gold.h"
#include "tests/support/hard_cages.h"
#include "tests/support/thorough.h"

namespace rebake::test {
namespace {

std::vector<Vec3> points_inside_flat() {  // in flat(1e-8), up to its walls
  std::vector<Vec3> points;
  for (const double height : {-5e-9, -4.9e-9, 0.0, 1e-12, 5e-9})
    for (int k = 0; k < 40; ++k) points.emplace_back(-0.34 + 0.017 * k, 0.3 * std::sin(k), height);
  return points;
}
TEST(MeanValue, SumsAndLinearFunctionsAreExactEverywhere) {
  for (const auto& [name, cage] : hard_cages()) {
    SCOPED_TRACE(name);
    const CoordinateErrors errors = errors_of(*mean_value_coordinates(cage), cage, hard_points(cage));
    EXPECT_LE(errors.sum, 1e-14) << name;
    EXPECT_LE(errors.linear, 2e-14) << name;
  }
}

TEST(MeanValue, AccurateAtAnyScaleAndFarFromTheOrigin) {
  for (const double scale : {1e-30, 1e-12, 1e12, 1e30}) {
    const Cage cage = scaled(dented(), scale);
    std::vector<Vec3> points = hard_points(dented());
    for (Vec3& point : points) point *= scale;
    const CoordinateErrors errors = errors_of(*mean_value_coordinates(cage), cage, points);
    EXPECT_LE(errors.sum, 1e-14) << scale;
    EXPECT_LE(errors.linear, 2e-14) << scale;
  }
  const Cage cage = scaled(dented(), 1, Vec3(1e6, -1e6, 1e6));
  const CoordinateErrors errors = errors_of(*mean_value_coordinates(cage), cage, hard_points(cage));
  EXPECT_LE(errors.sum, 1e-14);
  EXPECT_LE(errors.linear, 2e-14);
}

TEST(MeanValue, InsideAnExtremelyFlatCage) {
  const Cage cage = flat(1e-8);
  const CoordinateErrors errors = errors_of(*mean_value_coordinates(cage), cage, points_inside_flat());
  EXPECT_LE(errors.sum, 1e-14);
  EXPECT_LE(errors.linear, 2e-14);
}

TEST(MeanValue, LinearPrecisionAtTenDiagonals) {
  for (const auto& [name, cage] : hard_cages()) {
    const CoordinateErrors errors = errors_of(*mean_value_coordinates(cage), cage, {Vec3(7, 5, 6)});
    EXPECT_LE(errors.linear, 2e-12) << name;
  }
}

// Largest error of the weights at every `step`-th point, less the effect of moving that point by 1e-15 of the cage's
// diagonal. A point in doubles is no more accurate than that, and on a needle of height 1e-12 weights change by 1e12
// per unit of length.
double error_beyond_rounding(const Cage& cage, const Coordinates& coordinates,
                             std::vector<Gold> (*exact)(const Cage&, const Gold3&), const std::vector<Vec3>& points,
                             std::size_t step) {
  Box box;
  for (const Vec3& v : cage.vertices) box.extend(v);
  const double size = box.diagonal().stableNorm(), unit = frame_of(cage).scale;
  double worst = 0;
  for (std::size_t k = 0; k < points.size(); k += step) {
    std::vector<double> got = weights_at(coordinates, points[k]);
    std::vector<Gold> want = exact(cage, gold(points[k]));
    // Coincident cage vertices may split their weight in any ratio: compare the sum.
    for (std::size_t v = 0; v < cage.vertices.size(); ++v)
      for (std::size_t w = 0; w < v; ++w)
        if (cage.vertices[v] == cage.vertices[w]) {
          got[w] += std::exchange(got[v], 0);
          want[w] += std::exchange(want[v], Gold(0));
        }
    Gold sum = 0;
    for (std::size_t v = 0; v < cage.vertices.size(); ++v) sum += want[v];
    if (abs(sum - 1) > 1e-9) continue;  // outside by the exact sum; Green's coordinates are undefined there
    std::vector<Vec3> slopes;
    for (std::size_t row = 0; row < got.size(); ++row) {
      const double length = row < cage.vertices.size() ? 1 : unit;  // ψ is a length, in units of the cage frame
      double error = std::abs(static_cast<double>(want[row] * length - got[row]));
      if (!(error <= 1e-14)) {
        if (slopes.empty()) slopes = gold_gradients(exact, cage, points[k]);
        error -= 1e-15 * size * slopes[row].norm() * length;
      }
      worst = std::max(worst, error);
    }
  }
  return worst;
}

TEST(MeanValue, WeightsAgreeWith120DigitsOnEveryHardCage) {
  for (const auto& [name, cage] : hard_cages()) {
    Box box;
    for (const Vec3& v : cage.vertices) box.extend(v);
    std::vector<Vec3> near, beyond;  // up to 0.1 from the box, and beyond, where contributions of faces nearly cancel
    for (const Vec3& point : hard_points(cage)) (box.exteriorDistance(point) <= 0.1 ? near : beyond).push_back(point);
    const auto coordinates = mean_value_coordinates(cage);
    const std::size_t step = cage.faces.size() > 20 ? 61 : 3;
    EXPECT_LE(error_beyond_rounding(cage, *coordinates, gold_mean_value, near, step), 1e-14) << name;
    EXPECT_LE(error_beyond_rounding(cage, *coordinates, gold_mean_value, beyond, step), 1e-13) << name;
  }
}

TEST(MeanValue, WeightsAgreeWith120DigitsAtAnyScaleFarFromTheOriginAndInFlatCages) {
  for (const double scale : {1e-30, 1e-12, 1e12, 1e30}) {
    const Cage cage = scaled(cube(), scale);
    std::vector<Vec3> points = hard_points(cube());
    for (Vec3& point : points) point *= scale;
    EXPECT_LE(error_beyond_rounding(cage, *mean_value_coordinates(cage), gold_mean_value, points, 7), 1e-14) << scale;
  }
  const Cage far = scaled(cube(), 1, Vec3(1e6, -1e6, 1e6));
  EXPECT_LE(error_beyond_rounding(far, *mean_value_coordinates(far), gold_mean_value, hard_points(far), 7), 1e-14);
  const Cage thin = flat(1e-8);
  EXPECT_LE(error_beyond_rounding(thin, *mean_value_coordinates(thin), gold_mean_value, points_inside_flat(), 7),
            1e-14);
}

// All weights and gradients of the points, for bitwise comparison of implementations.
std::vector<double> all_bits(const Coordinates& coordinates, const std::vector<Vec3>& points) {
  std::vector<double> all, weights(coordinates.rows() * batch_lanes), slopes(coordinates.rows() * 3 * batch_lanes);
  for (std::size_t first = 0; first < points.size(); first += batch_lanes) {
    std::array<Vec3, batch_lanes> block;
    for (std::size_t lane = 0; lane < batch_lanes; ++lane)
      block[lane] = points[std::min(first + lane, points.size() - 1)];
    std::array<std::uint8_t, batch_lanes> outside;
    for (const bool gradients : {false, true}) {
      coordinates.compute_weights(block, weights.data(), gradients ? slopes.data() : nullptr, outside.data());
      all.insert(all.end(), weights.begin(), weights.end());
    }
    all.insert(all.end(), slopes.begin(), slopes.end());
  }
  return all;
}

// Machines of one batch may have different processors; an edit must give the same bits on all of them.
TEST(MeanValue, EveryVectorWidthGivesTheSameBits) {
  for (const auto& [name, cage] : hard_cages()) {
    std::vector<Vec3> points;
    for (const Vec3& point : hard_points(cage))
      if (points.size() < std::size_t{150} * thorough) points.push_back(point);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> any(-0.4, 0.4);
    for (int k = 0; k < 400; ++k) points.emplace_back(any(random), any(random), any(random));
    std::vector<double> first;
    for (const MeanValueBatch batch : mean_value_batches()) {
      const std::vector<double> bits = all_bits(*mean_value_coordinates(cage, batch), points);
      if (first.empty()) first = bits;
      ASSERT_EQ(bits.size(), first.size());
      EXPECT_EQ(std::memcmp(bits.data(), first.data(), bits.size() * sizeof(double)), 0) << name;
    }
  }
}

TEST(MeanValue, BatchesMatchSinglePoints) {
  const Cage cage = dented();
  const CageFrame frame = frame_of(cage);
  const auto coordinates = mean_value_coordinates(cage);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-0.2, 0.2);
  double worst = 0, worst_slope = 0;
  for (int k = 0; k < 300; ++k) {
    const Vec3 point(any(random), any(random), any(random));
    std::vector<Dual> one;
    mean_value_weights(frame, frame.to_local(point), one);
    std::vector<Vec3> slopes;
    const std::vector<double> many = weights_at(*coordinates, point, &slopes);
    for (std::size_t v = 0; v < one.size(); ++v) {
      worst = std::max(worst, std::abs(one[v].v - many[v]));
      const Vec3 slope = Vec3(one[v].x, one[v].y, one[v].z) * frame.scale;
      worst_slope = std::max(worst_slope, (slope - slopes[v]).norm() / std::max(1.0, slope.norm()));
    }
  }
  EXPECT_LE(worst, 1e-14);
  EXPECT_LE(worst_slope, 1e-11);
}

// A NaN, infinite or huge point does not affect the other points of its SIMD batch.
TEST(MeanValue, NonFinitePointsDoNotAffectTheirBatch) {
  const Cage cage = dented();
  std::vector<Vec3> points;
  for (const Vec3& point : hard_points(cage))
    if (points.size() < std::size_t{200} * thorough) points.push_back(point);
  std::vector<Vec3> moved = cage.vertices;
  for (Vec3& v : moved) v.x() += 0.3 * v.y() * v.y();
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL, 1e300}) {
    std::vector<Vec3> soiled = points;
    for (std::size_t k = 5; k < soiled.size(); k += batch_lanes) soiled[k][1] = bad;
    for (const MeanValueBatch batch : mean_value_batches()) {
      const auto coordinates = mean_value_coordinates(cage, batch);
      const DeformedPoints clean = deform_points(*coordinates, cage, moved, points, true),
                           beside = deform_points(*coordinates, cage, moved, soiled, true);
      for (std::size_t k = 0; k < points.size(); ++k) {
        if (k % batch_lanes == 5) continue;
        ASSERT_EQ(clean.points[k], beside.points[k]) << k;
        ASSERT_EQ(clean.jacobians[k], beside.jacobians[k]) << k;
      }
    }
  }
}

// Single precision, which the accuracy study compares with: the cage frame removes scales of 1e±12, so only float
// rounding remains.
TEST(MeanValue, FloatWeightsAreScaleInvariant) {
  std::vector<std::vector<float>> all;
  for (const double scale : {std::ldexp(1.0, -40), 1.0, std::ldexp(1.0, 40)}) {  // 1e±12
    const Cage cage = scaled(dented(), scale);
    const CageFrame frame = frame_of(cage);
    std::vector<float> of_scale;
    double worst = 0;
    for (const Vec3& point : hard_points(dented())) {
      std::vector<float> weights;
      mean_value_weights(frame, frame.to_local(point * scale), weights);
      double sum = 0;
      for (const float weight : weights) sum += static_cast<double>(weight);
      worst = std::max(worst, std::abs(sum - 1));
      of_scale.insert(of_scale.end(), weights.begin(), weights.end());
    }
    EXPECT_LE(worst, 1e-5) << scale;
    all.push_back(std::move(of_scale));
  }
  EXPECT_EQ(all[0], all[1]);
  EXPECT_EQ(all[2], all[1]);
}

TEST(Green, SumsAndLinearFunctionsAreExactInside) {
  for (const auto& [name, cage] : hard_cages()) {
    const CoordinateErrors errors = errors_of(*green_coordinates(cage), cage, inside_points(cage));
    EXPECT_LE(errors.sum, 1e-14) << name;
    EXPECT_LE(errors.linear, 1e-14) << name;
  }
}

TEST(Green, WeightsAgreeWith120DigitsOnEveryHardCage) {
  for (const auto& [name, cage] : hard_cages()) {
    const std::size_t step = cage.faces.size() > 20 ? 29 : 3;
    EXPECT_LE(error_beyond_rounding(cage, *green_coordinates(cage), gold_green, inside_points(cage), step), 1e-14)
        << name;
  }
}

TEST(Green, AccurateAtAnyScaleFarFromTheOriginAndInFlatCages) {
  for (const double scale : {1e-30, 1e-12, 1e12, 1e30}) {
    const Cage cage = scaled(cube(), scale);
    std::vector<Vec3> points = inside_points(cube());
    for (Vec3& point : points) point *= scale;
    const auto coordinates = green_coordinates(cage);
    EXPECT_LE(error_beyond_rounding(cage, *coordinates, gold_green, points, 7), 1e-14) << scale;
    const CoordinateErrors errors = errors_of(*coordinates, cage, points);
    EXPECT_LE(errors.sum, 1e-14) << scale;
    EXPECT_LE(errors.linear, 1e-14) << scale;
  }
  const Cage far = scaled(cube(), 1, Vec3(1e6, -1e6, 1e6));
  EXPECT_LE(error_beyond_rounding(far, *green_coordinates(far), gold_green, inside_points(far), 7), 1e-14);
  const Cage thin = flat(1e-8);
  std::vector<Vec3> within;
  for (const Vec3& point : points_inside_flat())
    if (std::abs(point.z()) < 4.95e-9) within.push_back(point);
  EXPECT_LE(error_beyond_rounding(thin, *green_coordinates(thin), gold_green, within, 7), 1e-14);
  const CoordinateErrors errors = errors_of(*green_coordinates(thin), thin, within);
  EXPECT_LE(errors.sum, 1e-14);
  EXPECT_LE(errors.linear, 1e-14);
}

TEST(Green, FiniteWeightsOnTheSurface) {
  const Cage cage = dented();
  const auto coordinates = green_coordinates(cage);
  for (const Vec3& point : hard_points(cage))
    for (const double weight : weights_at(*coordinates, point)) EXPECT_TRUE(std::isfinite(weight));
}

// Face stretches of needles: rounding must not be amplified by 1 / height.
TEST(Green, RigidMotionsDoNotStretchNeedles) {
  for (const double thin : {1e-3, 1e-6, 1e-9}) {
    const Cage cage = needles(thin);
    // A rotation by 90° moves the corners without rounding, so only the formula can err.
    Mat3 turn;
    turn << 0, -1, 0, 1, 0, 0, 0, 0, 1;
    std::vector<Vec3> moved = cage.vertices;
    for (Vec3& v : moved) v = turn * v;
    const std::vector<Vec3> motions = green_coordinates(cage)->row_motions(cage, moved);
    for (std::size_t f = 0; f < cage.faces.size(); ++f) {
      const Face& face = cage.faces[f];
      const Gold3 a = gold(cage.vertices[face[0]]), b = gold(cage.vertices[face[1]]), c = gold(cage.vertices[face[2]]);
      Gold3 n;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
        n[k] = (b[i] - a[i]) * (c[j] - a[j]) - (b[j] - a[j]) * (c[i] - a[i]);
      }
      const Gold size = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
      const Vec3 normal(static_cast<double>(n[0] / size), static_cast<double>(n[1] / size),
                        static_cast<double>(n[2] / size));
      const Vec3 want = (turn * normal - normal) / frame_of(cage).scale;
      EXPECT_LE((motions[cage.vertices.size() + f] - want).norm(), 1e-15) << thin << " face " << f;
    }
  }
}

TEST(MeanValue, FiniteAtAdversarialPoints) {
  const Cage cage = needles(1e-6);
  const auto coordinates = mean_value_coordinates(cage);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(-0.2, 1.2);
  std::uniform_int_distribution<std::size_t> face_of(0, cage.faces.size() - 1);
  std::uniform_int_distribution<int> exponent(-18, -1);
  std::vector<Vec3> points;
  for (int k = 0; k < cases(40'000, 400'000, 10'000); ++k) {
    const Face& face = cage.faces[face_of(random)];
    const double s = k % 3 == 0 ? 0 : any(random), t = k % 5 == 0 ? 0 : any(random);
    const double d = std::pow(10.0, exponent(random));
    points.push_back(cage.vertices[face[0]] * (1 - s - t) + cage.vertices[face[1]] * s + cage.vertices[face[2]] * t +
                     d * Vec3(any(random) - 0.5, any(random) - 0.5, any(random) - 0.5));
  }
  std::vector<Vec3> moved = cage.vertices;
  moved[4] += Vec3(0.1, 0.2, -0.1);
  std::size_t bad = 0;
  for (const Vec3& point : deform_points(*coordinates, cage, moved, points, false).points) bad += !point.allFinite();
  EXPECT_EQ(bad, 0U);
  // Fewer points, because gradients on edges take 0.25 ms each.
  points.resize(static_cast<std::size_t>(cases(2000, 20000, 500)));
  for (const Mat3& jacobian : deform_points(*coordinates, cage, moved, points, true).jacobians)
    bad += !jacobian.allFinite();
  EXPECT_EQ(bad, 0U);
}

}  // namespace
}  // namespace rebake::test
