// Shader programs in use are compiled once, and old ones are evicted.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "render/gl/context.h"
#include "render/graph/passes.h"

namespace rebake::test {
namespace {

TEST(ProgramCache, EvictsUnusedPrograms) {
  const auto context = gl::make_headless_context();
  const gl::CurrentContextScope current(*context);
  ProgramCache cache;
  const auto number = [&](int k) {
    return cache.get("fullscreen.vert", "outline.frag", fmt::format("#define NUMBER {}\n", k)).name();
  };
  const unsigned first = number(0), second = number(1);
  EXPECT_NE(first, second);
  for (int k = 2; k < 100; ++k) {
    number(k);
    EXPECT_EQ(number(0), first) << "a program in use must be compiled once";
  }
  const std::size_t kept = cache.size();
  EXPECT_LE(kept, 64U);
  number(1);
  EXPECT_EQ(cache.size(), kept) << "an evicted program replaces another one";
}

}  // namespace
}  // namespace rebake::test
