// What is known of an object is computed once, whichever threads ask for it, and all get the same.
#include "mesh_ops/index/index.h"

#include <gtest/gtest.h>

#include <thread>

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

}  // namespace
}  // namespace rebake::test
