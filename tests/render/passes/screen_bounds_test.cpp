// Basis of occlusion culling: screen bounds that contain all that a driver draws, and a conservative depth pyramid
// (Hi-Z).
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "render/passes/depth_pyramid.h"
#include "render/passes/screen_bounds.h"

namespace rebake::test {
namespace {

TEST(DepthPyramid, HidesOnlyTrianglesBehindAllCoveredSamples) {
  std::mt19937 random(9);
  std::uniform_real_distribution<float> depth(0.45F, 0.8F);
  std::uniform_real_distribution<double> place(0, 40), near(0, 1);
  const SampleRect rect{3, 5, 3 + 37, 5 + 23};
  std::vector<float> nearness(37UL * 23);
  for (float& n : nearness) n = depth(random);
  DepthPyramid pyramid;
  pyramid.build(rect, nearness);
  int hidden = 0, shown = 0;
  for (int k = 0; k < 20000; ++k) {
    ScreenTriangle t;
    for (std::size_t c = 0; c < 3; ++c) {
      t.x[c] = place(random);
      t.y[c] = place(random) * 0.8;
      t.nearness[c] = 0.6 * near(random);
    }
    t.moved = 0.3;
    t.error = 1e-2;
    const auto [x0, x1] = std::minmax_element(t.x.begin(), t.x.end());
    const auto [y0, y1] = std::minmax_element(t.y.begin(), t.y.end());
    t.samples = {static_cast<int>(*x0) - 1, static_cast<int>(*y0) - 1, static_cast<int>(*x1) + 1,
                 static_cast<int>(*y1) + 1};
    // As a driver may rasterise it: with displaced corners, and nearer.
    ScreenTriangle drawn = t;
    for (std::size_t c = 0; c < 3; ++c) {
      drawn.x[c] += t.moved * 0.7 * (2 * near(random) - 1);
      drawn.y[c] += t.moved * 0.7 * (2 * near(random) - 1);
      drawn.nearness[c] += t.error * near(random);
    }
    // Samples inside, by barycentric coordinates in long double.
    const auto cross = [](long double ax, long double ay, long double bx, long double by) { return ax * by - ay * bx; };
    const long double area =
        cross(drawn.x[1] - drawn.x[0], drawn.y[1] - drawn.y[0], drawn.x[2] - drawn.x[0], drawn.y[2] - drawn.y[0]);
    bool any = false;
    for (int v = 5; v < 5 + 23; ++v)
      for (int u = 3; u < 3 + 37; ++u) {
        const long double px = u + 0.5L - drawn.x[0], py = v + 0.5L - drawn.y[0];
        const long double b = cross(px, py, drawn.x[2] - drawn.x[0], drawn.y[2] - drawn.y[0]) / area,
                          c = cross(drawn.x[1] - drawn.x[0], drawn.y[1] - drawn.y[0], px, py) / area;
        if (b < 0 || c < 0 || b + c > 1) continue;
        const long double at = drawn.nearness[0] + b * (drawn.nearness[1] - drawn.nearness[0]) +
                               c * (drawn.nearness[2] - drawn.nearness[0]);
        any = any || nearness[static_cast<std::size_t>(v - 5) * 37 + static_cast<std::size_t>(u - 3)] <= at;
      }
    const bool hides = pyramid.hides(t);
    if (any) {
      ASSERT_FALSE(hides) << k;
    }
    hidden += hides ? 1 : 0;
    shown += any ? 1 : 0;
  }
  EXPECT_GT(hidden, 2000);
  EXPECT_GT(shown, 2000);
}

TEST(DepthPyramid, HidesOnlyRectanglesBehindAllSamples) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> depth(0.2F, 0.8F);
  const SampleRect rect{3, 5, 3 + 37, 5 + 23};
  std::vector<float> nearness(37UL * 23);
  for (float& n : nearness) n = depth(random);
  DepthPyramid pyramid;
  pyramid.build(rect, nearness);
  std::uniform_int_distribution<int> x(0, 45), y(0, 33);
  int hidden = 0;
  for (int k = 0; k < 20000; ++k) {
    const int a = x(random), b = x(random), c = y(random), d = y(random);
    const SampleRect samples{std::min(a, b), std::min(c, d), std::max(a, b), std::max(c, d)};
    const float at = 0.5F * depth(random);
    if (!pyramid.hides(samples, at)) continue;
    EXPECT_TRUE(pyramid.hides({400, 5, 900, 9}, at)) << "outside of the pyramid";
    ++hidden;
    for (int v = std::max(samples.bottom, 5); v <= std::min(samples.top, 5 + 22); ++v)
      for (int u = std::max(samples.left, 3); u <= std::min(samples.right, 3 + 36); ++u)
        ASSERT_GT(nearness[static_cast<std::size_t>(v - 5) * 37 + static_cast<std::size_t>(u - 3)], at);
  }
  EXPECT_GT(hidden, 1000);
}

// Bounds compared with the projection in long double: all corners must lie inside.
TEST(ScreenBounds, ContainTheirTriangles) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> u(-1, 1);
  const SampleRect rect{0, 0, 640, 480};
  std::size_t inside = 0, anywhere = 0;
  for (int round = 0; round < 400; ++round) {
    const double scale = std::pow(10.0, 3 * u(random)), away = scale * std::pow(10.0, 2 * u(random));
    Eigen::Matrix4d to_clip = Eigen::Matrix4d::Identity();
    to_clip(2, 2) = 0;
    to_clip(2, 3) = 0.01 * scale;
    to_clip(3, 2) = -1;
    to_clip(3, 3) = away;
    const Vec3 center = 5 * scale * Vec3(u(random), u(random), u(random));
    to_clip.col(3) -= to_clip.leftCols<3>() * center;
    const Box box(center - Vec3::Constant(scale), center + Vec3::Constant(scale));
    const ScreenBounder bounder(to_clip, box, {1, 0}, 640, 480, rect);
    ClusterCorners corners;
    for (auto& corner : corners.at)
      for (auto& axis : corner)
        for (float& at : axis) at = static_cast<float>(scale * u(random));
    ClusterBounds bounds;
    bounder.triangles(corners, bounds);
    for (std::size_t k = 0; k < max_faces_per_cluster; ++k) {
      using Where = ScreenBounds::Where;
      const auto where = static_cast<Where>(bounds.where[k]);
      anywhere += where == Where::anywhere ? 1 : 0;
      if (where != Where::inside) continue;
      ++inside;
      for (std::size_t c = 0; c < 3; ++c) {
        const auto at = [&](std::size_t axis) {
          return static_cast<long double>(center[static_cast<Eigen::Index>(axis)]) +
                 static_cast<long double>(corners.at[c][axis][k]);
        };
        long double clip[4];
        for (Eigen::Index row = 0; row < 4; ++row)
          clip[row] = to_clip(row, 0) * at(0) + to_clip(row, 1) * at(1) + to_clip(row, 2) * at(2) + to_clip(row, 3);
        const long double px = (clip[0] / clip[3] + 1) * 320, py = (clip[1] / clip[3] + 1) * 240;
        // The sample next to a corner on its inner side must be covered.
        if (px > 0 && px < 640) {
          EXPECT_LE(bounds.left[k], static_cast<int>(std::ceil(px - 0.5L)));
          EXPECT_GE(bounds.right[k], static_cast<int>(std::floor(px - 0.5L)));
        }
        if (py > 0 && py < 480) {
          EXPECT_LE(bounds.bottom[k], static_cast<int>(std::ceil(py - 0.5L)));
          EXPECT_GE(bounds.top[k], static_cast<int>(std::floor(py - 0.5L)));
        }
        EXPECT_GE(static_cast<long double>(bounds.nearness[k]), clip[2] / clip[3]);
      }
    }
  }
  EXPECT_GT(inside, 5000U);
  EXPECT_GT(anywhere, 1000U) << "triangles that cross the plane of the eye must be included";
}

TEST(ScreenBounds, NonFiniteTriangleMayBeAnywhere) {
  const ScreenBounder bounder(Eigen::Matrix4d::Identity(), Box(Vec3(-1, -1, -1), Vec3(1, 1, 1)), {1, 0}, 64, 64,
                              {0, 0, 64, 64});
  ClusterCorners corners{};
  for (std::size_t k = 0; k < max_faces_per_cluster; ++k) {
    corners.at[1][0][k] = corners.at[2][1][k] = 0.5F;  // a triangle with one coordinate that is not finite
    corners.at[k % 3][k / 3 % 3][k] = k % 5 == 0 ? NAN : INFINITY;
  }
  ClusterBounds bounds;
  bounder.triangles(corners, bounds);
  for (const std::int32_t where : bounds.where) EXPECT_EQ(where, static_cast<int>(ScreenBounds::Where::anywhere));
}

}  // namespace
}  // namespace rebake::test
