// Rays through placed objects give the same hits as each object's own ray tree.
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

TEST(SceneRays, CullingMatchesTestingAllObjects) {
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
      // Some mirrored, scaled non-uniformly, or inside others.
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
      // Half of the rays aim at an object; random rays from far away would miss all.
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

TEST(RayTree, SubsetTreeMatchesFullTree) {
  auto object = std::make_shared<BakedObject>(*made_object({.holes = false}));
  object->sets.push_back(made_object({.radius = 0.6, .holes = false})->sets[0]);
  const std::size_t outer = object->sets[0].soup.triangle_count();
  std::vector<std::uint32_t> some;
  for (std::uint32_t f = 0; f < object->triangle_count(); ++f)
    if (f >= outer || f % 3 != 0) some.push_back(f);
  const RayTree all(*object), part(std::make_shared<const RayTriangles>(*object, some), *object);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  int same = 0, inner = 0;
  for (int k = 0; k < 4000; ++k) {
    const Vec3 eye = 4 * Vec3(unit(random), unit(random), unit(random)),
               way = 0.3 * Vec3(unit(random), unit(random), unit(random)) - eye;
    if (eye.norm() < 1.5) continue;
    const auto expected = all.nearest(eye, way, 0, 9), found = part.nearest(eye, way, 0, 9);
    ASSERT_TRUE(expected && found);
    if (expected->triangle % 3 != 0) {
      EXPECT_EQ(std::tuple(found->t, found->triangle), std::tuple(expected->t, expected->triangle));
      ++same;
    } else {
      EXPECT_GT(found->t, expected->t);
      EXPECT_TRUE(found->triangle >= outer || found->triangle % 3 != 0);
      inner += found->triangle >= outer ? 1 : 0;
    }
  }
  EXPECT_GT(same, 1000);
  EXPECT_GT(inner, 200);
}

// A brush over a closed surface must not select its far side through the edges of its triangles.
TEST(RayTree, NothingLeaksThroughSharedEdges) {
  for (const int rows : {8, 60}) {
    const auto object = made_object({.columns = 2 * rows, .rows = rows, .cell = 5, .holes = false});
    const Soup& soup = object->sets[0].soup;
    const RayTree tree(*object);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(-1, 1), along(0, 1);
    int sent = 0;
    while (sent < 200000) {
      const Face& face = soup.faces()[random() % soup.triangle_count()];
      const std::size_t k = random() % 3;
      const Vec3 &a = soup.positions()[face[k]], &b = soup.positions()[face[(k + 1) % 3]];
      const Vec3 eye = 3 * Vec3(unit(random), unit(random), unit(random)), at = a + along(random) * (b - a),
                 way = at - eye;
      // From outside, onto the near half.
      if (eye.norm() < 1.5 || way.normalized().dot(at.normalized()) > -0.3) continue;
      ++sent;
      const auto hit = tree.nearest(eye, way, 0, 9);
      ASSERT_TRUE(hit) << eye.transpose() << " to " << at.transpose();
      ASSERT_LT(hit->t, 1.001) << eye.transpose() << " to " << at.transpose();
    }
  }
}

}  // namespace
}  // namespace rebake::test
