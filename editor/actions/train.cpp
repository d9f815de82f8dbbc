#include "editor/actions/train.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "editor/actions/describe_action.h"
#include "editor/actions/output_state.h"
#include "editor/training/training_judgement.h"
#include "editor/training/training_run.h"
#include "mesh_ops/base/counted.h"
#include "mesh_ops/base/duration.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/formats/export.h"
#include "mesh_ops/formats/mobilenerf/baked_files.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

ReconstructionOptions options_of(const TrainAction& action) {
  ReconstructionOptions options;
  options.source = {action.photographs, action.format.name, action.world, action.scale};
  options.held_out = {action.held_out, action.hold_out};
  options.kind = action.kind;
  options.minutes = action.minutes;
  options.steps = action.steps;
  options.side = action.side;
  options.near = action.near;
  options.far = action.far;
  options.seed = action.seed;
  if (action.fields != "hash" && action.fields != "mlp")
    throw FieldError("fields", "\"" + action.fields + "\" is not known (known: hash, mlp)");
  options.mlp = action.fields == "mlp";
  options.width = action.width;
  options.octaves = action.octaves;
  options.layers = action.layers;
  options.gains = !action.one_exposure;
  options.four_rays = !action.one_ray;
  options.samples = action.samples;
  options.fresh = action.fresh;
  return options;
}

constexpr const char* report_name = "rebake_training.json";

// Throws FileError if the report would replace a file of the user.
void check_report_is_ours(const fs::path& file) {
  std::error_code gone;
  if (!fs::exists(file, gone)) return;
  const nlohmann::json there = nlohmann::json::parse(read_file(file), nullptr, false);
  if (!there.is_object() || there.value("software", nlohmann::json()) != "Rebake")
    throw FileError(file, "is no report of a training; move it, or choose another output folder");
}

SourceGuard sources_of(const Session& session, const TrainingObserver& observer) {
  SourceGuard all = session.document.sources();
  if (observer.more_sources) all.add_all(observer.more_sources(), "a source of the open document");
  return all;
}

// Bakes coarse textures for the observer. The next preview waits until nine times the time of this one has passed.
void show(TrainingRun& run, const TrainingObserver& observer, const Progress& progress) {
  constexpr int samples = 5;
  constexpr double waits = 9;
  TrainingPreview preview;
  preview.rows = run.progress_rows();
  preview.cameras = run.capture().cameras;
  const auto start = std::chrono::steady_clock::now();
  try {
    BakeReconstructionCounts counts;
    preview.object = bake(run.reconstruction(), {samples, false, false}, counts, progress);
  } catch (const Cancelled&) {
    throw;
  } catch (const Error&) {
    // Nothing is opaque yet.
  }
  observer.preview(preview);
  const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  run.watch_seconds = std::max(run.watch_seconds, waits * took);
}

nlohmann::json number(double value) { return std::round(value * 1000) / 1000; }

// Compares the scene with the held-out photographs, says and returns the result.
nlohmann::json judge(Session& session, const TrainingRun& run, const Scene& scene) {
  const Capture& capture = run.capture();
  if (capture.held_out.empty()) return nullptr;
  const bool gain = run.reconstruction().has_gains();
  const TrainingBaselines simple = baselines(run.reconstruction().views().photographs(), capture.held_out);
  const Vec3& background = run.frame().background;
  nlohmann::json report = {{"photographs", capture.held_out.size()},
                           {"background", {number(background.x()), number(background.y()), number(background.z())}},
                           {"mean colour PSNR dB", number(simple.mean_color_db)},
                           {"white picture PSNR dB", number(simple.white_db)},
                           {"nearest photograph PSNR dB", number(simple.nearest_photograph_db)}};
  std::string beside = fmt::format("mean colour {:.2f} dB, nearest photograph {:.2f} dB", simple.mean_color_db,
                                   simple.nearest_photograph_db);
  if (!gain) {
    const double unbaked = held_out_psnr(run.reconstruction(), capture, session.progress);
    report["before baking PSNR dB"] = number(unbaked);
    beside += fmt::format(", before baking {:.2f} dB", unbaked);
  }
  try {
    const MeanErrors errors = held_out_errors(session.renderer(), scene, capture, gain, session.progress);
    report["PSNR dB"] = number(errors.psnr_db);
    report["SSIM"] = number(errors.ssim);
    report["FLIP"] = number(errors.flip);
    session.say(fmt::format("{}{}: {:.2f} dB, SSIM {:.4f}, FLIP {:.4f} ({})",
                            counted(capture.held_out.size(), "held-out photograph"), gain ? " after a gain each" : "",
                            errors.psnr_db, errors.ssim, errors.flip, beside));
    constexpr double better = 1;
    if (errors.psnr_db < better + std::max(simple.mean_color_db, simple.nearest_photograph_db))
      session.say(
          "warning: the scene is hardly better than one colour or the nearest photograph: train longer, or check "
          "that poses, world, scale and kind belong to the photographs");
  } catch (const DeviceError& error) {
    session.say(fmt::format("warning: the scene was not compared with photographs: {}", error.what()));
  }
  return report;
}

nlohmann::json report_of(const TrainingRun& run, const TrainAction& action, const BakeReconstructionCounts& counts,
                         const BakedObject& object) {
  nlohmann::json rows = nlohmann::json::array();
  for (const auto& [steps, seconds, psnr] : run.progress_rows())
    rows.push_back({steps, std::round(seconds * 10) / 10, number(psnr)});
  nlohmann::json report = {{"software", "Rebake"},
                           {"photographs", run.reconstruction().views().photographs().size()},
                           {"seed", action.seed},
                           {"steps", run.reconstruction().plan().steps()},
                           {"steps done", run.reconstruction().steps_done()},
                           {"side", run.reconstruction().plan().side},
                           {"minutes", number(run.seconds() / 60)},
                           {"plan", words_of(run.reconstruction().plan())},
                           {"frame", run.frame().notes},
                           {"notes", run.capture().notes},
                           {"triangles", object.triangle_count()},
                           {"opaque texels", counts.opaque_texels},
                           {"quads", {{"opaque", counts.quads}, {"visible", counts.visible_quads}}},
                           {"steps, seconds, PSNR dB", rows}};
  return report;
}

}  // namespace

std::vector<fs::path> TrainAction::input_files(const nlohmann::json& object) {
  const auto text = [&](const char* field) {
    const auto found = object.find(field);
    return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
  };
  if (text("photographs").empty()) return {};
  return files_of_capture({text("photographs"), text("format") == "auto" ? "" : text("format"), std::nullopt, 1},
                          {text("held_out"), 0});
}

void run(Session& session, const TrainAction& action, const TrainingObserver& observer) {
  const ReconstructionOptions options = options_of(action);
  check(options);
  if (action.out.empty()) throw FieldError("out", "is empty");
  for (const fs::path& file : files_of_capture(options.source, options.held_out))
    session.document.protect_file(file, "a file of the capture");
  check_can_export(action.out, sources_of(session, observer));
  const fs::path out = absolute_path(action.out), work = out.string() + ".training";
  check_report_is_ours(out / report_name);
  const OutputState before(out);
  if (before.had_content() && observer.may_replace)
    session.say(fmt::format("note: {} exists already; its scene is replaced after the training", out.string()));
  Capture capture = read_capture(options.source, options.held_out, Scene{}.background, session.progress);
  for (const std::string& note : capture.notes) session.say(note);
  TrainingRun training(options, std::move(capture), Scene{}.background, work, sources_of(session, observer),
                       session.say, session.progress);
  session.say(fmt::format("progress: a picture and a table in {}", work.string()));
  training.enough = observer.enough;
  training.goes_on_unsaved = observer.goes_on_unsaved;
  if (observer.preview)
    training.watch = [&](TrainingRun& now, const Progress& progress) { show(now, observer, progress); };
  training.train(session.progress);
  if (training.is_saved()) session.say("trained; if the rest is stopped, the same command goes on from here");

  BakeReconstructionOptions baking;
  baking.samples = action.samples;
  BakeReconstructionCounts counts;
  Node node;
  node.name = out.filename().string();
  node.object = bake(training.reconstruction(), baking, counts, session.progress);
  Scene scene = with_added({}, node, NodeId::none, 0);
  scene.background = training.frame().background;
  const SourceGuard sources = sources_of(session, observer);
  if (before.has_other_content() || (!observer.may_replace && before.has_content()))
    throw FileError(out,
                    "was written by something else during the training; move it elsewhere, and train again with "
                    "the same options: the training is kept and goes on from here");
  ExportOptions exporting;
  exporting.sources = sources;
  const ExportReport exported = export_scene(scene, out, exporting, session.progress);
  for (const std::string& note : exported.notes) session.say("note: " + note);
  session.wrote_scene(action.out, true);
  session.say(fmt::format("stage 3: {} triangles and {} opaque texels of {} visible quads (of {}), after {}",
                          node.object->triangle_count(), counts.opaque_texels, counts.visible_quads, counts.quads,
                          duration_text(training.seconds())));
  nlohmann::json report = report_of(training, action, counts, *node.object);
  report["held out"] = judge(session, training, scene);
  report["scene"] = hash_text(baked_hash(out));  // later runs replace the report with the scene if both are as written
  write_file_atomically(out / report_name, report.dump(1) + "\n", sources_of(session, observer));
  training.remove_work_files();
  session.say(fmt::format("wrote the scene to {}; its rebake_training.json has the plan and all figures", action.out));
}

REBAKE_DESCRIBE_ACTION(
    TrainAction, "Trains a scene from photographs with known cameras, and writes it as a MobileNeRF folder.",
    (auto& action, auto& visit) {
      visit("photographs", action.photographs, Need::required,
            "camera file or folder of the photographs, as for import_views (transforms.json, transforms_train.json, "
            "COLMAP, poses_bounds.npy)");
      visit("out", action.out, Need::required, "folder to write; checkpoints are written to OUT.training beside it");
      visit("kind", action.kind, Need::optional,
            "object: cameras around an object; forward: cameras on one side; unbounded: cameras amid a scene");
      visit(
          "minutes", action.minutes, Need::optional,
          "about how long it may take, by the time of a step on this machine; repeat it with steps for the same bytes");
      visit("steps", action.steps, Need::optional,
            "number of steps; default: about 17000, more for large grids and few photographs");
      visit("side", action.side, Need::optional,
            "cells per side of the grid, 16 to 256; default: by the photographs, 32 to 128");
      visit("near", action.near, Need::optional,
            "forward: nearest depth; default: as the camera file states, else assumed");
      visit("far", action.far, Need::optional,
            "forward: farthest depth; default: as the camera file states, else assumed");
      visit("seed", action.seed, Need::optional, "start of the random numbers");
      visit("fields", action.fields, Need::optional,
            "hash: hash grids; mlp: the published networks, by LibTorch, on a graphics card if LibTorch has CUDA "
            "(untested)");
      visit("width", action.width, Need::optional, "mlp: neurons per layer; published: 384");
      visit("octaves", action.octaves, Need::optional, "mlp: octaves of sines that encode positions; published: 10");
      visit("layers", action.layers, Need::optional, "mlp: number of layers; published: 8");
      visit("format", action.format, Need::optional, "format of the camera file; auto: recognised");
      visit("world", action.world, Need::optional, "axis that points up in the camera file, as for import_views");
      visit("scale", action.scale, Need::optional, "factor of the cameras' positions");
      visit("held_out", action.held_out, Need::optional,
            "camera file of photographs to judge the result by; default: transforms_test.json beside "
            "transforms_train.json");
      visit("hold_out", action.hold_out, Need::optional,
            "without such a file: every n-th photograph judges the result; 0: none");
      visit("one_exposure", action.one_exposure, Need::optional, "give no gains to photographs of other exposure");
      visit("one_ray", action.one_ray, Need::optional, "one ray per pixel in stage 2 instead of four");
      visit("samples", action.samples, Need::optional, "texels between the corners of a quad");
      visit("fresh", action.fresh, Need::optional, "start again instead of going on from a checkpoint");
    })

}  // namespace rebake
