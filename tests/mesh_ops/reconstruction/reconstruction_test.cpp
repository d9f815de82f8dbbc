#include "mesh_ops/reconstruction/reconstruction.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstdlib>

#include "mesh_ops/base/error.h"
#include "mesh_ops/reconstruction/bake_reconstruction.h"
#include "mesh_ops/reconstruction/capture_frame.h"
#include "tests/support/ball_photographs.h"

using namespace rebake;

namespace {

TrainingPlan tiny_plan(int side, std::uint64_t seed) {
  TrainingPlan plan;
  plan.side = side;
  plan.seed = seed;
  plan.levels = 3;
  plan.log2_entries = 6;
  plan.hidden = 8;
  plan.open_steps = 3;
  plan.soft_steps = 6;
  plan.binary_steps = 4;
  plan.feature_steps = 2;
  plan.open_rays = plan.soft_rays = 8;
  plan.pixels = 4;
  plan.open_hits = plan.soft_hits = plan.pixel_hits = 16;
  return plan;
}

Reconstruction begin_training(const TrainingPlan& plan, const std::vector<FitPhotograph>& photographs) {
  return {plan, TrainingViews(photographs, plan.to_unit, Axes::y_up), Vec3::Ones(), fields_of(plan)};
}

void finish_training(Reconstruction& training) {
  while (training.stage() != TrainingStage::done) training.step();
}

}  // namespace

TEST(Reconstruction, GivesTheSameBytesForOneSeedAtAnyNumberOfThreads) {
  const auto photographs = ball_photographs(4, 12);
  std::vector<std::string> results;
  for (const std::size_t threads : {1, 4}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    Reconstruction training = begin_training(tiny_plan(8, 1), photographs);
    finish_training(training);
    results.push_back(training.save());
  }
  Reconstruction other = begin_training(tiny_plan(8, 2), photographs);
  finish_training(other);
  EXPECT_EQ(results[0], results[1]);
  EXPECT_NE(results[0], other.save());
}

TEST(Reconstruction, GoesOnFromASavedStateWithTheSameNumbers) {
  const auto photographs = ball_photographs(4, 12);
  Reconstruction whole = begin_training(tiny_plan(8, 1), photographs);
  std::vector<std::string> states;
  for (; whole.stage() != TrainingStage::done; whole.step()) states.push_back(whole.save());
  const std::string last = whole.save();
  // In each stage.
  for (const std::size_t step : {2U, 7U, 11U}) {
    Reconstruction half = begin_training(tiny_plan(8, 1), photographs);
    half.load(states[step]);
    EXPECT_EQ(half.steps_done(), step);
    finish_training(half);
    EXPECT_EQ(half.save(), last);
  }
}

TEST(Reconstruction, RefusesStatesOfOtherPlansAndDamagedOnes) {
  const auto photographs = ball_photographs(4, 12);
  const std::string state = begin_training(tiny_plan(8, 1), photographs).save();
  Reconstruction other = begin_training(tiny_plan(9, 1), photographs);
  EXPECT_THROW(other.load(state), Error);
  Reconstruction same = begin_training(tiny_plan(8, 1), photographs);
  EXPECT_THROW(same.load(state.substr(0, state.size() / 2)), Error);
  EXPECT_THROW(same.load(state + "x"), Error);
}

TEST(Reconstruction, NoRandomStartGivesNumbersThatAreNotFinite) {
  const auto photographs = ball_photographs(2, 6);
  // All of them take ten seconds.
  const std::uint64_t starts = std::getenv("REBAKE_DEEP") != nullptr ? 10000 : 1000;
  for (std::uint64_t seed = 0; seed < starts; ++seed) {
    Reconstruction training = begin_training(tiny_plan(4 + static_cast<int>(seed % 3), seed), photographs);
    while (training.stage() != TrainingStage::done) ASSERT_TRUE(std::isfinite(training.step())) << seed;
    for (const float offset : training.grid().offsets) ASSERT_TRUE(std::isfinite(offset)) << seed;
    for (const float value : training.decoder().values) ASSERT_TRUE(std::isfinite(value)) << seed;
  }
}

// A coloured ball: learned in all stages, and baked without loss.
TEST(Reconstruction, LearnsABallThatTheBakedObjectShows) {
  const auto photographs = ball_photographs(24, 24), held_out = ball_photographs(5, 24, 0.5);
  TrainingPlan plan = tiny_plan(16, 1);
  plan.to_unit = object_frame(photographs, Vec3::Ones(), 2.0 / plan.side).to_unit;
  plan.levels = 5;
  plan.log2_entries = 12;
  plan.hidden = 16;
  plan.open_steps = 200;
  plan.soft_steps = 600;
  plan.binary_steps = 400;
  plan.feature_steps = 100;
  plan.open_rays = plan.soft_rays = 128;
  plan.pixels = 64;
  plan.open_hits = plan.soft_hits = plan.pixel_hits = 48;
  Reconstruction training = begin_training(plan, photographs);
  finish_training(training);
  const TrainingViews views(held_out, plan.to_unit, Axes::y_up);
  double error = 0;
  for (std::size_t k = 0; k < held_out.size(); ++k)
    error += training.error_of(views, k, nullptr) / static_cast<double>(held_out.size());
  // The mean colour has 9 dB, a white picture 8 dB.
  EXPECT_LT(error, std::pow(10.0, -2.2));

  BakeReconstructionCounts counts;
  const auto object = bake(training, {}, counts, {});
  EXPECT_GT(counts.visible_quads, 100U);
  EXPECT_LT(counts.visible_quads, counts.quads);  // the inside of the ball is left out
  EXPECT_EQ(object->axes, Axes::y_up);
  EXPECT_EQ(object->decoder->hidden0(), 16);
  // All vertices lie around the ball of radius ½.
  for (const TextureSet& set : object->sets)
    for (const Vec3& position : set.soup.positions()) EXPECT_LT(position.norm(), 0.75);
}

TEST(Reconstruction, SaysThatNothingIsOpaqueBeforeItIsTrained) {
  const auto photographs = ball_photographs(4, 12);
  const Reconstruction training = begin_training(tiny_plan(8, 1), photographs);
  BakeReconstructionCounts counts;
  EXPECT_THROW(bake(training, {}, counts, {}), Error);
}
