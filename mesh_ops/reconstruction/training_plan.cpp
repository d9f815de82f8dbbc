#include "mesh_ops/reconstruction/training_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rebake {

namespace {

// Steps without empty cells left out, in which each cell is hit about this many times. (The published run hits each
// 6,600 times.)
std::size_t open_steps_for(const TrainingPlan& plan, double hits) {
  return static_cast<std::size_t>(std::ceil(hits * plan.side * plan.side / static_cast<double>(plan.open_rays)));
}

}  // namespace

TrainingPlan plan_for(CaptureKind kind, int side, std::size_t pixels, std::uint64_t seed) {
  TrainingPlan plan;
  plan.kind = kind;
  plan.side = side;
  plan.seed = seed;
  plan.open_hits = static_cast<std::size_t>(3 * side);
  plan.soft_hits = static_cast<std::size_t>(3 * side / 2);
  plan.pixel_hits = static_cast<std::size_t>(3 * side / 4);
  // A surface passes through some side² cells, each with a few entries of the finest level.
  plan.log2_entries = static_cast<int>(std::lround(std::log2(32.0 * side * side)));
  // 17,000 steps of stages 1 and 2 see each pixel some ten times.
  constexpr std::size_t fewest = 256, most = 1024, steps_per_pixel = 1600;
  plan.soft_rays = std::clamp(pixels / steps_per_pixel, fewest, most);
  plan.open_rays = plan.pixels = plan.soft_rays / 2;
  constexpr double usual_hits = 190;
  const std::size_t open_steps = open_steps_for(plan, usual_hits);
  plan.soft_steps += open_steps - plan.open_steps;
  plan.open_steps = open_steps;
  if (kind == CaptureKind::forward) plan.distortion = 0.01;
  if (kind == CaptureKind::unbounded) {
    plan.distortion = 0.001;
    plan.boxes = std::min(65, side / 2 + 1);
    plan.log2_entries += 1;  // the boxes fill half the fields' space
  }
  return plan;
}

TrainingPlan with_steps(TrainingPlan plan, double steps) {
  const double factor = steps / static_cast<double>(plan.steps());
  const auto scaled = [&](std::size_t count, std::size_t least) {
    return std::max(least, static_cast<std::size_t>(std::lround(factor * static_cast<double>(count))));
  };
  constexpr double least_hits = 65;
  constexpr std::size_t least_others = 100;
  const std::size_t culled = scaled(plan.soft_steps - plan.open_steps, least_others);
  plan.open_steps = scaled(plan.open_steps, open_steps_for(plan, least_hits));
  plan.soft_steps = plan.open_steps + culled;
  plan.binary_steps = scaled(plan.binary_steps, least_others);
  plan.feature_steps = scaled(plan.feature_steps, least_others);
  return plan;
}

double open_steps_of_time(const TrainingPlan& plan) {
  constexpr double soft = 0.25, binary = 0.31, features = 0.1;
  return static_cast<double>(plan.open_steps) + soft * static_cast<double>(plan.soft_steps - plan.open_steps) +
         binary * static_cast<double>(plan.binary_steps) + features * static_cast<double>(plan.feature_steps);
}

std::vector<std::string> words_of(const TrainingPlan& plan) {
  const char* const kind = plan.kind == CaptureKind::object    ? "object"
                           : plan.kind == CaptureKind::forward ? "forward-facing capture"
                                                               : "unbounded scene";
  std::vector<std::string> lines{
      fmt::format("{}: a grid of {}³ cells (published: 128³)", kind, plan.side),
      fmt::format("stage 1: {} steps of {} rays without and {} steps of {} rays with empty cells left out (published: "
                  "50,000 and 150,000 steps of 16,384 to 65,536 rays)",
                  plan.open_steps, plan.open_rays, plan.soft_steps - plan.open_steps, plan.soft_rays),
      fmt::format("stage 2: {} and {} steps of {} pixels with {} (published: up to 400,000 and 100,000 steps of 16,384 "
                  "pixels with four rays each)",
                  plan.binary_steps, plan.feature_steps, plan.pixels,
                  plan.four_rays ? "four rays each" : "one ray each"),
      plan.mlp
          ? fmt::format("fields: the published networks with {} layers of {} neurons and {} octaves (published: 8 of "
                        "384 and 10)",
                        plan.layers, plan.width, plan.octaves)
          : fmt::format(
                "fields: hash grids of {} levels with up to {} entries and networks of 2 × {} neurons (published: "
                "networks of 8 × 384 neurons)",
                plan.levels, 1 << plan.log2_entries, plan.hidden)};
  lines.push_back(plan.distortion > 0 ? fmt::format("distortion loss: weight {}", plan.distortion)
                                      : "distortion loss: none, as published for objects");
  lines.push_back(plan.boxes > 0
                      ? fmt::format("nested boxes: {}, for everything around the grid (published: 65)", plan.boxes)
                      : "nested boxes: none, only unbounded scenes need them");
  lines.push_back(plan.gains ? "exposures: a gain per photograph if backgrounds differ, or if gains explain errors in "
                               "the middle of stage 1"
                             : "exposures: no gains");
  return lines;
}

}  // namespace rebake
