// The synthetic scene for benchmarks has the statistics of real unbounded scenes.
#include "samples/synthetic/large_scene.h"

#include <gtest/gtest.h>

#include "mesh_ops/index/index.h"

namespace rebake::test {
namespace {

TEST(LargeScene, MatchesStatisticsOfRealScenes) {
  // The same ratios with a tenth of the triangles and texels.
  const LargeSceneOptions options{.triangles = 72'300, .texture_side = 1295};
  const auto object = large_synthetic_scene(options);
  EXPECT_EQ(object->sets.size(), 8U);
  EXPECT_NEAR(static_cast<double>(object->triangle_count()), 72'300, 16);
  EXPECT_NEAR(static_cast<double>(object->vertex_count()) / static_cast<double>(corners_of(*object)->place_count), 1.9,
              0.05);
  const double texels = 8.0 * options.texture_side * options.texture_side;
  EXPECT_NEAR(static_cast<double>(object->opaque_texel_count()) / texels, 0.59, 0.02);
  const Box box = object->bounds();
  EXPECT_LE(box.min().cwiseAbs().maxCoeff(), options.extent);
  EXPECT_LE(box.max().cwiseAbs().maxCoeff(), options.extent);
  EXPECT_GE(box.diagonal().norm(), options.extent);
}

TEST(LargeScene, IsDeterministic) {
  const LargeSceneOptions options{.sets = 2, .triangles = 400, .texture_side = 200};
  const auto a = large_synthetic_scene(options), b = large_synthetic_scene(options);
  for (std::size_t s = 0; s < 2; ++s) {
    EXPECT_EQ(a->sets[s].soup.positions(), b->sets[s].soup.positions());
    const TexelReader first(*a->sets[s].texels), second(*b->sets[s].texels);
    for (int y = 0; y < options.texture_side; ++y)
      for (int x = 0; x < options.texture_side; ++x) ASSERT_EQ(first.at(x, y), second.at(x, y));
  }
}

}  // namespace
}  // namespace rebake::test
