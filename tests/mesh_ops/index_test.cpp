// What is known of an object is computed once, whichever threads ask for it, and all get the same.
#include "mesh_ops/index/index.h"

#include <gtest/gtest.h>

#include <thread>

#include "mesh_ops/base/error.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

TEST(Index, ManyThreadsAskAtOnceAndShareWhatOneMade) {
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

TEST(Index, IsSharedByWhatSharesTheArraysAndByNothingElse) {
  const BakedObject object = *made_object({.columns = 8, .rows = 4});
  const BakedObject copy = object;
  EXPECT_EQ(traits_of(object), traits_of(copy));
  EXPECT_EQ(rays_of(object).get(), rays_of(copy).get());
  const Joining wide{.tolerance = 0.1, .gap = 0.2};
  EXPECT_EQ(components_of(object, wide), components_of(copy, wide));
  EXPECT_NE(components_of(object, wide), components_of(object));
  // Other texels change what is seen, not which corners meet.
  BakedObject painted = object;
  painted.sets[0].texels = std::make_shared<const FeatureTexture>(*object.sets[0].texels);
  EXPECT_EQ(corners_of(object), corners_of(painted));
  EXPECT_NE(traits_of(object), traits_of(painted));
  EXPECT_NE(rays_of(object).get(), rays_of(painted).get());
}

TEST(Index, GoesWithTheArrays) {
  const auto stays = made_object({.columns = 4, .rows = 2});
  traits_of(*stays);  // what earlier tests left goes
  const std::size_t before = index_cache().size();
  {
    const auto object = made_object({.columns = 8, .rows = 4});
    prepare_index(*object);
    EXPECT_GT(rays_of(*object)->memory(), 1000U);
    EXPECT_GE(index_cache().size(), before + 3);
  }
  const auto other = made_object({.columns = 4, .rows = 4});
  traits_of(*other);
  EXPECT_LE(index_cache().size(), before + 1) << "what was known of arrays that are gone is gone";
}

struct Block {
  std::uint64_t bytes;
};
std::uint64_t memory_of(const Block& block) { return block.bytes; }

TEST(ArrayCache, KeepsToItsBudgetAndDropsWhatWasUsedLeastRecently) {
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
  get(2);  // drops 1
  EXPECT_EQ(cache.memory(), 80U);
  EXPECT_EQ(get(0), first);
  EXPECT_EQ(made, 3);
  get(1);
  EXPECT_EQ(made, 4) << "it is made again";
  EXPECT_EQ(cache.if_there<Block>({arrays[2]}, {}), nullptr);
  // What is larger than the budget is kept alone.
  const auto big = cache.get<Block>({arrays[0], arrays[1]}, {}, [] { return Block{1000}; });
  EXPECT_EQ(cache.size(), 1U);
  // What throws is asked for again.
  const auto fails = [&] { return cache.get<Block>({arrays[2]}, {1}, []() -> Block { throw Error("no"); }); };
  EXPECT_THROW(fails(), Error);
  EXPECT_NO_THROW(cache.get<Block>({arrays[2]}, {1}, [] { return Block{1}; }));
}

}  // namespace
}  // namespace rebake::test
