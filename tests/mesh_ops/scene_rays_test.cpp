// Rays through placed objects find what each object's own tree does.
#include "mesh_ops/rays/scene_rays.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

TEST(SceneRays, WhatIsPassedByIsNotAskedAndChangesNothing) {
  const auto object = made_object({.columns = 16, .rows = 8});
  const auto tree = std::make_shared<const RayTree>(*object);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto some = [&] { return Vec3(unit(random), unit(random), unit(random)); };
  for (const double scale : {1.0, 1e-6, 1e6}) {
    std::vector<SceneRays::Instance> instances;
    for (int k = 0; k < 8; ++k) {
      // Some mirrored, squeezed, or inside others.
      Affine place = Affine::Identity();
      place.translate(scale * 4 * some()).rotate(Eigen::AngleAxisd(3 * unit(random), some().normalized()));
      place.scale(scale * Vec3(k % 3 == 0 ? -1 : 1, std::pow(10, unit(random)), 0.5));
      instances.push_back({tree, place, object->bounds().diagonal().norm()});
    }
    const SceneRays rays(instances);
    int shaded = 0;
    for (int k = 0; k < 20000; ++k) {
      const Vec3 from = scale * (k % 4 == 0 ? 1e4 : 5) * some();
      // Some towards an object, which random ones from afar would not meet.
      const Vec3 direction =
          k % 2 == 0 ? some().normalized()
                     : (instances[static_cast<std::size_t>(k % 8)].to_world.translation() + scale * some() - from)
                           .normalized();
      bool any = false;
      double nearest = std::numeric_limits<double>::infinity();
      for (const SceneRays::Instance& one : instances) {
        const Affine back = one.to_world.inverse();
        any |= tree->blocked(back * from, back.linear() * direction, 0, one.reach);
        if (const auto hit = tree->nearest(back * from, back.linear() * direction, 0, nearest)) nearest = hit->t;
      }
      ASSERT_EQ(rays.shaded(from, direction), any) << scale << ", ray " << k;
      const auto hit = rays.nearest(from, direction, 0, std::numeric_limits<double>::infinity());
      ASSERT_EQ(hit ? hit->t : std::numeric_limits<double>::infinity(), nearest) << scale << ", ray " << k;
      shaded += any ? 1 : 0;
    }
    EXPECT_GT(shaded, 3000);
    EXPECT_LT(shaded, 18000);
  }
}

}  // namespace
}  // namespace rebake::test
