#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "editor/studies/representations/marched_volume.h"
#include "editor/studies/representations/plenoctree_fit.h"
#include "editor/studies/representations/snerg_fit.h"
#include "render/compare.h"
#include "tests/support/marched_picture.h"

namespace rebake {
namespace {

// A ball whose colour depends on the place and a little on the direction.
std::optional<double> distance_to_ball(const Vec3& eye, const Vec3& direction) {
  const double along = -eye.dot(direction), inside = along * along - eye.squaredNorm() + 1;
  return inside < 0 ? std::nullopt : std::optional(along - std::sqrt(inside));
}
Color color_of_ball(const Vec3& at, const Vec3& direction) {
  return (0.5 + 0.3 * (2 * at.array()).sin() - 0.15 * direction.array()).matrix();
}

TruthRays rays_of_ball(int count) {
  std::mt19937 random(3);
  const auto unit = [&] { return random() / 2147483647.5 - 1; };
  TruthRays result;
  while (static_cast<int>(result.rays.size()) < count) {
    const Vec3 eye = 3 * Vec3(unit(), unit(), unit()).normalized(), aim = 1.3 * Vec3(unit(), unit(), unit());
    const Vec3 direction = (aim - eye).normalized();
    const auto distance = distance_to_ball(eye, direction);
    Color color = Color::Ones();
    if (distance) {
      result.hits.emplace_back(eye + *distance * direction);
      color = color_of_ball(result.hits.back(), direction);
    }
    result.rays.push_back(
        {eye.cast<float>(),
         direction.cast<float>(),
         {static_cast<float>(color.x()), static_cast<float>(color.y()), static_cast<float>(color.z())}});
  }
  return result;
}

View view_of_fit() {
  View view;
  view.camera.eye = {1.6, 1.2, 2.2};
  view.camera.fov_degrees = 50;
  view.width = view.height = 64;
  return view;
}

Image truth_of_ball(View view) {
  view.samples = 16;
  return test::marched_picture(view, [](const Vec3& eye, const Vec3& direction) -> Color {
    const auto distance = distance_to_ball(eye, direction);
    return distance ? color_of_ball(eye + *distance * direction, direction) : Color(Color::Ones());
  });
}

// PSNR after 1, 2 and 4 passes; the last picture.
template <class Fit>
std::vector<double> curve_of(const Fit& fit, Image& last) {
  const TruthRays rays = rays_of_ball(60000);
  const auto context = gl::make_headless_context();
  const View view = view_of_fit();
  const Image truth = truth_of_ball(view);
  std::vector<double> curve;
  fit(rays, [&](int passes, const auto& volume) {
    last = MarchedVolume(volume, *context).picture(view);
    curve.push_back(compare(last, truth, 2).psnr_db);
    return passes < 4;
  });
  return curve;
}

TEST(SnergFit, LearnsABallAndIsDeterministic) {
  const auto fit = [](const TruthRays& rays, auto goes_on) { fit_snerg(rays, 16, goes_on, {}); };
  Image first, second;
  const std::vector<double> curve = curve_of(fit, first);
  ASSERT_EQ(curve.size(), 3U);
  EXPECT_GT(curve.back(), 24);
  EXPECT_GT(curve.back(), curve.front() + 2);
  EXPECT_EQ(curve_of(fit, second), curve);
  EXPECT_EQ(first, second);
}

TEST(PlenOctreeFit, LearnsABallAndIsDeterministic) {
  const auto fit = [](const TruthRays& rays, auto goes_on) { fit_plenoctree(rays, 16, goes_on, {}); };
  Image first, second;
  const std::vector<double> curve = curve_of(fit, first);
  ASSERT_EQ(curve.size(), 3U);
  EXPECT_GT(curve.back(), 24);
  EXPECT_GT(curve.back(), curve.front() + 1);
  EXPECT_EQ(curve_of(fit, second), curve);
  EXPECT_EQ(first, second);
}

TEST(PlenOctreeFit, RemovesLeavesThatNoRaySees) {
  const TruthRays rays = rays_of_ball(60000);
  fit_plenoctree(rays, 32,
                 [](int passes, const PlenOctree& tree) {
                   if (passes < 4) return true;
                   // Only the shell is left: fewer leaves than half of the ball's cube.
                   std::size_t leaves = 0;
                   for (std::size_t slot = 0; slot < tree.children.size() * 8; ++slot)
                     leaves += static_cast<float>(tree.data[slot * tree.record() + 27]) > 0 ? 1 : 0;
                   EXPECT_GT(leaves, 500U);
                   EXPECT_LT(leaves, 32U * 32U * 32U / 2);
                   return false;
                 },
                 {});
}

}  // namespace
}  // namespace rebake
