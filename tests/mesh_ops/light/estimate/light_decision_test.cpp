// Summaries of many light decisions.
#include "mesh_ops/light/estimate/light_decision.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace rebake::test {
namespace {

TEST(LightDecisions, ListsFewDecisionsWithRunningOnesFirst) {
  const std::vector<LightDecision> few{
      {"cast shadow", "cast shadow a→b", false, 0.001, 0, "at most 0.3 of 255", ""},
      {"self-shadow", "self-shadow b", true, 0.1, 0.5, "about 25 of 255", "took 0.5 s"}};
  const auto said = summarised(few);
  ASSERT_EQ(said.size(), 2U);
  EXPECT_EQ(said[0].name, "self-shadow b");
  EXPECT_EQ(said[1].why, few[0].why);
}

TEST(LightDecisions, JoinsManyEqualDecisions) {
  std::vector<LightDecision> many;
  for (int k = 1; k <= 20; ++k) {
    many.push_back({"cast shadow", fmt::format("cast shadow {}→a", k), false, k / 255.0, 0, "a bound", ""});
    many.push_back({"cast shadow", fmt::format("cast shadow a→{}", k), true, k / 51.0, 0.25, "a bound", "took 0.25 s"});
    many.push_back({"self-shadow", fmt::format("self-shadow {}", k), false, 0, 0, "no triangle moved", ""});
    many.push_back({"light estimate", fmt::format("light estimate {}", k), true, 0, 0, "explains 90 %", ""});
  }
  // Decisions that differ only in their time become one line.
  for (int k = 1; k <= 9; ++k)
    many.push_back({"highlights", fmt::format("highlights {}", k), true, 0, 0.5, "together", fmt::format("{} s", k)});
  many.push_back({"self-shadow", "self-shadow a", false, 0, 0, "disabled in the light settings", ""});
  const auto said = summarised(many);
  ASSERT_EQ(said.size(), 6U);
  EXPECT_EQ(said[0].name, "20 cast shadows");
  EXPECT_TRUE(said[0].runs);
  EXPECT_EQ(said[0].why, "cast shadow a→20 changes most, by up to 100 of 255");
  EXPECT_EQ(said[0].took, "took 5.00 s");
  EXPECT_EQ(said[1].why, "explains 90 %");
  EXPECT_EQ(said[2].name, "9 highlights");
  EXPECT_EQ(said[2].words(), "together, took 4.50 s");
  EXPECT_EQ(said[3].why, "up to 20 of 255 each, 210 together");
  EXPECT_EQ(said[4].name, "20 self-shadows");
  EXPECT_EQ(said[4].why, "no triangle moved");
  EXPECT_EQ(said[5].name, "self-shadow a");
}

}  // namespace
}  // namespace rebake::test
