// Indices of an object are computed once, whichever thread asks first, and shared by all threads.
#include "mesh_ops/index/index.h"

#include <gtest/gtest.h>

#include <thread>

#include "mesh_ops/base/error.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

TEST(Index, ThreadsShareOneComputation) {
  const auto object = made_object({.columns = 16, .rows = 8});
  struct Seen {
    const void *traits, *components, *rays;
    bool operator==(const Seen&) const = default;
  };
  std::array<Seen, 6> seen;
  std::vector<std::thread> threads;
  for (Seen& mine : seen)
    threads.emplace_back([&object, &mine] {
      mine = {traits_of(*object).get(), components_of(*object).get(), rays_of(*object).get()};
      rays_of(*object)->nearest({0, 0, 5}, {0, 0, -1}, 0, 10);
    });
  for (std::thread& thread : threads) thread.join();
  for (const Seen& one : seen) EXPECT_EQ(one, seen[0]);
}

TEST(Index, SharedByEqualArraysOnly) {
  const BakedObject object = *made_object({.columns = 8, .rows = 4});
  const BakedObject copy = object;
  EXPECT_EQ(traits_of(object), traits_of(copy));
  EXPECT_EQ(rays_of(object).get(), rays_of(copy).get());
  const Connectivity wide{.tolerance = 0.1, .gap = 0.2};
  EXPECT_EQ(components_of(object, wide), components_of(copy, wide));
  EXPECT_NE(components_of(object, wide), components_of(object));
  // Other texels invalidate traits and ray trees, but not welded corners.
  BakedObject painted = object;
  painted.sets[0].texels = std::make_shared<const FeatureTexture>(*object.sets[0].texels);
  EXPECT_EQ(corners_of(object), corners_of(painted));
  EXPECT_NE(traits_of(object), traits_of(painted));
  EXPECT_NE(rays_of(object).get(), rays_of(painted).get());
}

// Components found per texture set and then joined equal the components of the whole object.
TEST(Index, ComponentsOfSetsMatchTheWhole) {
  // One sphere in three texture sets that share corners: triangle t lies in set t mod 3.
  const BakedObject whole = *made_object({.columns = 24, .rows = 12});
  BakedObject parts = whole;
  parts.sets.clear();
  for (std::size_t s = 0; s < 3; ++s) {
    TriangleSet keep(whole.triangle_count());
    for (std::size_t t = 0; t < keep.size(); ++t) keep[t] = t % 3 == s ? 1 : 0;
    parts.sets.push_back({subset(whole.sets[0].soup, keep, 0, true), whole.sets[0].texels});
  }
  const auto found = components_of(parts);
  std::vector<std::shared_ptr<const EdgeOpacity>> opacity;
  for (const TextureSet& set : parts.sets) opacity.push_back(std::make_shared<const EdgeOpacity>(edge_opacity(set)));
  const Components wanted = opaque_components(parts, *corners_of(parts), *edges_of(parts), opacity, 0);
  EXPECT_EQ(found->part_of, wanted.part_of);
  EXPECT_EQ(found->triangles_in, wanted.triangles_in);
  EXPECT_EQ(found->triangles_in.size(), components_of(whole)->triangles_in.size());
  EXPECT_LT(found->triangles_in.size(), whole.triangle_count());
}

// Moving a part of a set keeps texel-based traits of its triangles, also if vertices are split.
TEST(Index, TexelTraitsSurviveMoves) {
  const auto object = made_object({.columns = 8, .rows = 4});
  TriangleSet some(object->triangle_count(), 0);
  some[5] = some[6] = 1;
  BakedObject moved = *object;
  moved.sets[0].soup =
      move_faces(object->sets[0].soup, some, 0, Affine(Eigen::Translation3d(0, 1, 0)), Mat3::Identity());
  ASSERT_NE(moved.sets[0].soup.shared_faces(), object->sets[0].soup.shared_faces());
  const auto before = traits_of(*object), after = traits_of(moved);
  for (std::size_t t = 0; t < before->size(); ++t) {
    EXPECT_EQ((*before)[t].features, (*after)[t].features);
    EXPECT_EQ((*before)[t].color, (*after)[t].color);
  }
  // Traits of a subset are computed again.
  BakedObject part = *object;
  part.sets[0].soup = subset(object->sets[0].soup, some, 0, true);
  EXPECT_EQ(traits_of(part)->size(), 2U);
  EXPECT_EQ((*traits_of(part))[0].features, (*before)[5].features);
}

TEST(Index, EvictedWithItsArrays) {
  const auto stays = made_object({.columns = 4, .rows = 2});
  traits_of(*stays);  // evicts entries of arrays that earlier tests freed
  const std::size_t before = index_cache().size();
  {
    const auto object = made_object({.columns = 8, .rows = 4});
    prepare_index(*object);
    const BakedObject unseen = *made_object({.columns = 8, .rows = 4, .seed = 2});
    const std::uint64_t memory = index_cache().memory();
    rays_of(unseen);
    const std::uint64_t of_triangles = index_cache().memory() - memory;
    EXPECT_GT(of_triangles, 1000U);
    BakedObject painted = unseen;
    painted.sets[0].texels = std::make_shared<const FeatureTexture>(*unseen.sets[0].texels);
    rays_of(painted);
    EXPECT_LT(index_cache().memory() - memory, of_triangles + 1000) << "other texels, the same triangles";
    EXPECT_GE(index_cache().size(), before + 3);
  }
  const auto other = made_object({.columns = 4, .rows = 4});
  traits_of(*other);
  EXPECT_LE(index_cache().size(), before + 3) << "entries of deleted arrays must be evicted";
}

struct Block {
  std::uint64_t bytes;
};
std::uint64_t memory_of(const Block& block) { return block.bytes; }

TEST(ArrayCache, EvictsLeastRecentlyUsedWithinBudget) {
  ArrayCache cache(100);
  const std::vector<std::shared_ptr<const int>> arrays{std::make_shared<int>(1), std::make_shared<int>(2),
                                                       std::make_shared<int>(3)};
  int made = 0;
  const auto get = [&](std::size_t which) {
    return cache.get<Block>({arrays[which]}, {}, [&] { return ++made, Block{40}; });
  };
  const auto first = get(0);
  get(1);
  get(0);
  get(2);  // evicts array 1
  EXPECT_EQ(cache.memory(), 80U);
  EXPECT_EQ(get(0), first);
  EXPECT_EQ(made, 3);
  get(1);
  EXPECT_EQ(made, 4) << "an evicted value must be made again";
  EXPECT_EQ(cache.try_get<Block>({arrays[2]}, {}), nullptr);
  // A value larger than the budget evicts all others.
  const auto big = cache.get<Block>({arrays[0], arrays[1]}, {}, [] { return Block{1000}; });
  EXPECT_EQ(cache.size(), 1U);
  // If making a value throws, nothing is cached and the next call tries again.
  const auto fails = [&] { return cache.get<Block>({arrays[2]}, {1}, []() -> Block { throw Error("no"); }); };
  EXPECT_THROW(fails(), Error);
  EXPECT_NO_THROW(cache.get<Block>({arrays[2]}, {1}, [] { return Block{1}; }));
}

}  // namespace
}  // namespace rebake::test
