// Rays through placed objects find what each object's own tree does.
#include "mesh_ops/rays/scene_rays.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <tuple>

#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

TEST(SceneRays, WhatIsPassedByIsNotAskedAndChangesNothing) {
  const auto object = made_object({.columns = 16, .rows = 8});
  const auto tree = std::make_shared<const RayTree>(*object);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto some = [&] { return Vec3(unit(random), unit(random), unit(random)); };
  for (const auto& [scale, count, broken] : {std::tuple(1.0, 8, false),
                                             {1e-6, 8, false},
                                             {1e6, 8, false},
                                             {1.0, 60, false},
                                             {1e-6, 60, false},
                                             {1.0, 20, true}}) {
    SCOPED_TRACE(testing::Message() << count << " objects at scale " << scale);
    std::vector<SceneRays::Instance> instances;
    for (int k = 0; k < count; ++k) {
      // Some mirrored, squeezed, or inside others.
      Affine place = Affine::Identity();
      place.translate(scale * 0.5 * count * some()).rotate(Eigen::AngleAxisd(3 * unit(random), some().normalized()));
      place.scale(scale * Vec3(k % 3 == 0 ? -1 : 1, std::pow(10, unit(random)), 0.5));
      if (broken && k % 7 == 3) place.translation().x() = std::numeric_limits<double>::quiet_NaN();
      instances.push_back({tree, place, object->bounds().diagonal().norm()});
    }
    const SceneRays rays(instances);
    int shaded = 0;
    const int sent = 160000 / count;
    for (int k = 0; k < sent; ++k) {
      const Vec3 from = scale * (k % 4 == 0 ? 1e4 : 5) * some();
      // Some towards an object, which random ones from afar would not meet.
      const Vec3 direction =
          k % 2 == 0 ? some().normalized()
                     : (instances[static_cast<std::size_t>(k % count)].to_world.translation() + scale * some() - from)
                           .normalized();
      bool any = false;
      double nearest = std::numeric_limits<double>::infinity();
      std::optional<std::size_t> first;
      for (std::size_t number = 0; number < instances.size(); ++number) {
        const SceneRays::Instance& one = instances[number];
        const Affine back = one.to_world.inverse();
        any |= tree->blocked(back * from, back.linear() * direction, 0, one.reach);
        if (const auto hit = tree->nearest(back * from, back.linear() * direction, 0, nearest)) {
          nearest = hit->t;
          first = number;
        }
      }
      ASSERT_EQ(rays.shaded(from, direction), any) << "ray " << k;
      const auto hit = rays.nearest(from, direction, 0, std::numeric_limits<double>::infinity());
      ASSERT_EQ(hit ? hit->t : std::numeric_limits<double>::infinity(), nearest) << "ray " << k;
      ASSERT_EQ(hit ? std::optional(hit->instance) : std::nullopt, first) << "ray " << k;
      shaded += any ? 1 : 0;
    }
    EXPECT_GT(shaded, sent / 8);
    EXPECT_LT(shaded, sent * 9 / 10);
  }
}

// Whichever way a tree is built: what a brush finds must not depend on what was indexed before.
TEST(RayTree, SomeTrianglesAndBundlesGiveWhatAllDoOneByOne) {
  // Every triangle twice, at the same places, and rays to corners and edges: most of what is met is met at one t.
  auto object = std::make_shared<BakedObject>(*made_object({.holes = false}));
  object->sets.push_back(object->sets[0]);
  const Soup& soup = object->sets[0].soup;
  const RayTree all(*object);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<std::uint32_t> met;
  std::vector<Vec3> eyes, ways;
  for (int k = 0; k < 4000; ++k) {
    const Face& face = soup.faces()[random() % soup.triangle_count()];
    const Vec3 &a = soup.positions()[face[0]], &b = soup.positions()[face[1]];
    eyes.push_back(4 * Vec3(unit(random), unit(random), unit(random)));
    ways.push_back((k % 2 == 0 ? a : Vec3((a + b) / 2)) - eyes.back());
    if (const auto hit = all.nearest(eyes.back(), ways.back(), 0, 9)) {
      EXPECT_LT(hit->triangle, soup.triangle_count()) << "the lower number of two";
      met.push_back(hit->triangle);
    }
  }
  ASSERT_GT(met.size(), 3000U);
  for (std::uint32_t f = 0; f < object->triangle_count(); f += 3) met.push_back(f);
  std::sort(met.begin(), met.end());
  met.erase(std::unique(met.begin(), met.end()), met.end());
  const RayTree some(std::make_shared<const RayTriangles>(*object, met), *object);
  for (std::size_t first = 0; first < eyes.size(); first += 8) {
    RayTree::Bundle bundle;
    for (std::size_t k = 0; k < 8; ++k) {
      bundle.origins[k] = eyes[first + k];
      bundle.directions[k] = ways[first + k];
      bundle.far[k] = 9;
    }
    RayTree::Bundle of_some = bundle;
    all.nearest(bundle, 0);
    some.nearest(of_some, 0);
    for (std::size_t k = 0; k < 8; ++k) {
      const auto hit = all.nearest(eyes[first + k], ways[first + k], 0, 9),
                 here = some.nearest(eyes[first + k], ways[first + k], 0, 9);
      ASSERT_EQ(bundle.hit[k], hit.has_value());
      ASSERT_EQ(of_some.hit[k], hit.has_value());
      ASSERT_EQ(here.has_value(), hit.has_value());
      if (!hit) continue;
      EXPECT_EQ(std::tuple(here->t, here->triangle), std::tuple(hit->t, hit->triangle));
      EXPECT_EQ(std::tuple(bundle.far[k], bundle.triangle[k]), std::tuple(hit->t, hit->triangle));
      EXPECT_EQ(std::tuple(of_some.far[k], of_some.triangle[k]), std::tuple(hit->t, hit->triangle));
    }
  }
}

}  // namespace
}  // namespace rebake::test
