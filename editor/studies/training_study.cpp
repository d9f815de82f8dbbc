#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "editor/edits/select/selecting.h"
#include "editor/edits/shared_result_cache.h"
#include "editor/studies/folder_size.h"
#include "editor/studies/study.h"
#include "editor/training/training_judgement.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/base/result_cache.h"
#include "mesh_ops/index/index.h"
#include "mesh_ops/reconstruction/bake_reconstruction.h"
#include "mesh_ops/reconstruction/capture_frame.h"
#include "mesh_ops/refit/photograph_fit.h"

namespace rebake {

namespace {

constexpr double not_measured = std::numeric_limits<double>::quiet_NaN();

// One training of the study.
struct TrainingChoice {
  std::string name;
  int side = 32;
  double steps = 4000;
  bool binary = true;     // the part of stage 2 in which opacity becomes binary
  bool four_rays = true;  // see TrainingPlan
  bool refit = false;     // features and decoder of the result are fitted to the photographs once more
};

std::vector<TrainingChoice> choices() {
  return {{"1500 steps", 32, 1500},
          {"3000 steps", 32, 3000},
          {"6000 steps", 32, 6000},
          {"12000 steps", 32, 12000},
          {"24 cells", 24, 6000},
          {"48 cells", 48, 6000},
          {"64 cells", 64, 6000},
          {"no binary loss", 32, 6000, false},
          {"one ray per pixel", 32, 6000, true, false},
          {"refitted", 32, 6000, true, true, true}};
}

// Pictures of a scene as photographs: 64² pixels, 16 samples per pixel, from all around.
Capture pictures_of(const StudyInput& input) {
  constexpr int pixels = 64, count = 60, every = 5;
  const Box bounds = world_bounds(input.scene);
  Capture capture;
  for (int k = 0; k < count; ++k) {
    Camera camera = framing(bounds, 1, false);
    const Vec3 out = camera.eye - bounds.center();
    const double angle = 2 * std::numbers::pi * k * 0.6180339887498949,
                 up = 0.1 + 0.8 * ((k * 7) % count) / static_cast<double>(count);
    camera.eye = bounds.center() + out.norm() * Vec3(std::cos(angle) * std::sqrt(1 - up * up), up,
                                                     std::sin(angle) * std::sqrt(1 - up * up));
    camera.target = bounds.center();
    View view = input.view;
    view.camera = with_planes(camera, bounds, 1);
    view.width = view.height = pixels;
    view.samples = 16;
    Photograph photograph{fmt::format("{:02}", k), camera, input.renderer().render(input.scene, view), {}, false};
    photograph.valid.assign(static_cast<std::size_t>(pixels) * pixels, 1);
    if (k % every == 0)
      capture.held_out.push_back(std::move(photograph));
    else
      capture.training.push_back(for_fit(std::move(photograph)));
  }
  return capture;
}

std::string state_of(const Capture& capture, const TrainingChoice& choice) {
  std::string bytes =
      fmt::format("{} {} {} {} {}\n", choice.side, choice.steps, choice.binary, choice.four_rays, choice.refit);
  for (const FitPhotograph& one : capture.training) bytes.append(one.rgb.begin(), one.rgb.end());
  for (const Photograph& one : capture.held_out) bytes.append(one.image.rgb.begin(), one.image.rgb.end());
  return bytes;
}

Scene scene_with(std::shared_ptr<const BakedObject> object, const Vec3& background) {
  Node node;
  node.name = "trained";
  node.object = std::move(object);
  Scene scene = with_added({}, node, NodeId::none, 0);
  scene.background = background;
  return scene;
}

Scene trained_scene(const Capture& capture, const TrainingChoice& choice, const Progress& progress) {
  std::size_t pixels = 0;
  for (const FitPhotograph& one : capture.training) pixels += one.valid.size();
  const CaptureFrame frame = object_frame(capture.training, Vec3::Ones(), 2.0 / choice.side);
  TrainingPlan plan = with_steps(plan_for(CaptureKind::object, choice.side, pixels, 1), choice.steps);
  plan.to_unit = frame.to_unit;
  plan.four_rays = choice.four_rays;
  if (!choice.binary) {
    plan.feature_steps += plan.binary_steps;
    plan.binary_steps = 0;
  }
  Reconstruction training(plan, TrainingViews(capture.training, plan.to_unit, trained_axes), frame.background,
                          fields_of(plan));
  while (training.stage() != TrainingStage::done) {
    training.step();
    progress.at("training, " + choice.name,
                static_cast<double>(training.steps_done()) / static_cast<double>(plan.steps()));
  }
  BakeReconstructionCounts counts;
  Scene scene = scene_with(bake(training, {}, counts, progress), frame.background);
  if (!choice.refit) return scene;
  const std::vector<PlacedNode> placed = selectable(scene, std::nullopt);
  FitOfPhotographsOptions options;
  options.decoder = true;
  const FitOfPhotographs fit =
      fit_to_photographs({{placed[0], TriangleSet(placed[0].node->object->triangle_count(), 1)}}, rays_through(placed),
                         capture.training, options, progress);
  return scene_with(fit.objects.begin()->second, frame.background);
}

}  // namespace

StudyTable study_training(const StudyInput& input) {
  StudyTable table{{"minutes", "held-out PSNR dB", "SSIM", "triangles", "megabytes"}, {}, 0, 1, true, false};
  const bool own_pictures = input.photographs.empty();
  const Capture capture =
      own_pictures ? pictures_of(input) : read_capture({input.photographs}, {}, input.scene.background, input.progress);
  if (capture.held_out.empty()) throw Error("the study needs photographs that are held out");
  const TrainingBaselines simple = baselines(capture.training, capture.held_out);
  table.rows.push_back({"white picture", {not_measured, simple.white_db, not_measured, 0, 0}});
  table.rows.push_back({"mean colour", {not_measured, simple.mean_color_db, not_measured, 0, 0}});
  table.rows.push_back({"nearest photograph", {not_measured, simple.nearest_photograph_db, not_measured, 0, 0}});
  const MeanErrors own = held_out_errors(input.renderer(), input.scene, capture, false, input.progress);
  table.rows.push_back({own_pictures ? "the photographed scene itself" : "as baked from the true surface",
                        {not_measured, own.psnr_db, own.ssim, static_cast<double>(triangles_in(input.scene)),
                         folder_megabytes(input.scene)}});
  const std::shared_ptr<ResultCache> results = result_cache();
  for (const TrainingChoice& choice : choices()) {
    const std::string key = result_key("training study 1", state_of(capture, choice));
    if (const auto known = results ? results->find(key) : std::nullopt) {
      table.rows.push_back({choice.name, nlohmann::json::parse(*known).get<std::vector<double>>()});
      continue;
    }
    const auto start = std::chrono::steady_clock::now();
    const Scene scene = trained_scene(capture, choice, input.progress);
    const double minutes =
        std::chrono::duration<double, std::ratio<60>>(std::chrono::steady_clock::now() - start).count();
    const MeanErrors errors = held_out_errors(input.renderer(), scene, capture, false, input.progress);
    table.rows.push_back(
        {choice.name,
         {minutes, errors.psnr_db, errors.ssim, static_cast<double>(triangles_in(scene)), folder_megabytes(scene)}});
    if (results) results->keep(key, nlohmann::json(table.rows.back().values).dump());
  }
  return table;
}

}  // namespace rebake
