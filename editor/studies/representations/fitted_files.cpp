#include "editor/studies/representations/fitted_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "editor/studies/representations/marched_volume.h"
#include "editor/studies/representations/plenoctree_files.h"
#include "editor/studies/representations/plenoctree_fit.h"
#include "editor/studies/representations/snerg_files.h"
#include "editor/studies/representations/snerg_fit.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/export.h"
#include "render/compare.h"
#include "samples/bakery/bake.h"

namespace rebake {

namespace fs = std::filesystem;
using Method = FittedFiles::Method;

namespace {

constexpr double enough_db = 0.2;  // a doubling that gains less is the last
constexpr int first_epochs = 10, most_epochs = 160;
constexpr int curve_views = 2;

double mean_psnr(const std::vector<HeldOutView>& views, const std::function<Image(const View&)>& draw) {
  double sum = 0;
  for (const HeldOutView& one : views) sum += compare(draw(one.view), one.truth, 2).psnr_db;
  return sum / static_cast<double>(views.size());
}

// Measures the curve of a fit while it is fitted.
class Budget {
 public:
  Budget(const StudyInput& input, FittedFiles& fitted, std::vector<HeldOutView> views, int most)
      : input_(input), fitted_(fitted), views_(std::move(views)), most_(most) {}

  // Whether doubling `passes` is worth while.
  bool goes_on(int passes, const std::function<Image(const View&)>& draw) {
    const double now = mean_psnr(views_, draw);
    const double gain = fitted_.curve.empty() ? std::numeric_limits<double>::infinity() : now - fitted_.curve.back()[1];
    fitted_.curve.push_back({static_cast<double>(passes), now});
    fitted_.passes = passes;
    input_.say(fmt::format("{}, {}: {:.2f} dB after {} {}", fitted_.sample, fitted_.name, now, passes,
                           fitted_.method == Method::mobilenerf ? "epochs" : "passes"));
    return gain >= enough_db && 2 * passes <= most_;
  }
  template <class Volume>
  bool goes_on_with(int passes, const Volume& volume) {
    MarchedVolume drawing(volume, input_.renderer().context());
    return goes_on(passes, [&](const View& view) { return drawing.picture(view); });
  }

 private:
  const StudyInput& input_;
  FittedFiles& fitted_;
  std::vector<HeldOutView> views_;
  int most_;
};

Scene scene_of(const std::shared_ptr<const BakedObject>& object) {
  Node node;
  node.object = object;
  return with_added({}, std::move(node), NodeId::none, 0);
}

void fit_mobilenerf(const StudyInput& input, const RepresentationSizes& sizes, SampleTruth& truth, FittedFiles& fitted,
                    Budget& budget) {
  for (int epochs = first_epochs;; epochs *= 2) {
    const auto object = bakery::bake(
        truth.model(), truth.field(),
        {.epochs = epochs, .observations = sizes.views, .texels_per_side = fitted.resolution}, input.progress);
    const Scene scene = scene_of(object);
    if (budget.goes_on(epochs, [&](const View& view) { return input.renderer().render(scene, view); })) continue;
    export_scene(scene, fitted.folder / "baked", {}, input.progress);
    return;
  }
}

void fit(const StudyInput& input, const RepresentationSizes& sizes, SampleTruth& truth, FittedFiles& fitted) {
  std::vector<HeldOutView> views = truth.held_out(fitted.folder.parent_path());
  views.resize(std::min<std::size_t>(views.size(), curve_views));
  const bool epochs = fitted.method == Method::mobilenerf;
  Budget budget(input, fitted, std::move(views), epochs ? most_epochs : sizes.most_passes);
  const auto start = std::chrono::steady_clock::now();
  fs::create_directories(fitted.folder);
  if (epochs) {
    fit_mobilenerf(input, sizes, truth, fitted, budget);
  } else if (fs::create_directories(fitted.folder / "baked"); fitted.method == Method::snerg) {
    const SnergScene scene = fit_snerg(
        truth.rays(), fitted.resolution,
        [&](int passes, const SnergScene& now) { return budget.goes_on_with(passes, now); }, input.progress);
    write_snerg(scene, fitted.folder / "baked", {});
  } else {
    const PlenOctree tree = fit_plenoctree(
        truth.rays(), fitted.resolution,
        [&](int passes, const PlenOctree& now) { return budget.goes_on_with(passes, now); }, input.progress);
    write_plenoctree(tree, fitted.folder / "baked" / "tree.npz", {});
    fs::create_directories(fitted.folder / "web");
    write_quantised_plenoctree(tree, fitted.folder / "web" / "tree.npz", {});
  }
  fitted.minutes = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / 60;
}

// What fit() found out; written last, so that an interrupted fit is repeated.
void write_result(const FittedFiles& fitted) {
  const nlohmann::json result{{"minutes", fitted.minutes}, {"passes", fitted.passes}, {"curve", fitted.curve}};
  write_file_atomically(fitted.folder / "fit.json", result.dump(), {});
}

bool read_result(FittedFiles& fitted) {
  std::error_code error;
  const fs::path file = fitted.folder / "fit.json";
  if (!fs::is_regular_file(file, error)) return false;
  try {
    const nlohmann::json result = nlohmann::json::parse(read_file(file));
    fitted.minutes = result.at("minutes");
    fitted.passes = result.at("passes");
    fitted.curve = result.at("curve").get<std::vector<std::array<double, 2>>>();
  } catch (const nlohmann::json::exception&) {
    throw FileError(file, "is damaged; remove its folder to fit this representation again");
  }
  return true;
}

}  // namespace

SampleTruth::SampleTruth(std::string sample, const RepresentationSizes& sizes, const Progress& progress)
    : model_(procedural_model(sample)), sizes_(sizes), progress_(progress) {}

const bakery::RadianceField& SampleTruth::field() {
  if (!field_) field_ = std::make_unique<bakery::RadianceField>(model_);
  return *field_;
}

const TruthRays& SampleTruth::rays() {
  if (!rays_)
    rays_ = std::make_unique<TruthRays>(traced_rays(model_, field(), sizes_.views, sizes_.ray_side, progress_));
  return *rays_;
}

std::vector<HeldOutView> SampleTruth::held_out(const fs::path& folder) {
  const auto file = [&](int k) { return folder / fmt::format("truth-{}.png", k); };
  std::error_code error;
  fs::create_directories(folder);
  std::vector<HeldOutView> views = held_out_views(model_, sizes_.held_out, sizes_.picture);
  for (int k = 0; k < sizes_.held_out; ++k) {
    HeldOutView& one = views[static_cast<std::size_t>(k)];
    if (fs::is_regular_file(file(k), error)) {
      one.truth = read_image(file(k));
      continue;
    }
    progress_.at("tracing held-out views", static_cast<double>(k) / sizes_.held_out);
    one.truth = field().trace(one.view.camera, one.view.width, one.view.height);
    write_picture(one.truth, file(k), {});
  }
  return views;
}

std::vector<FittedFiles> fitted_files(const StudyInput& input, const RepresentationSizes& sizes,
                                      const std::string& sample, SampleTruth& truth, const fs::path& folder) {
  std::vector<FittedFiles> all;
  for (const int side : sizes.texels)
    all.push_back({sample, Method::mobilenerf, side, fmt::format("MobileNeRF, {0}×{0} texels", side),
                   folder / fmt::format("mobilenerf-{}", side)});
  for (const int resolution : sizes.resolutions)
    all.push_back({sample, Method::snerg, resolution, fmt::format("SNeRG {}³", resolution),
                   folder / fmt::format("snerg-{}", resolution)});
  for (const int resolution : sizes.resolutions)
    all.push_back({sample, Method::plenoctree, resolution, fmt::format("PlenOctree {}³", resolution),
                   folder / fmt::format("plenoctree-{}", resolution)});
  for (FittedFiles& fitted : all) {
    if (read_result(fitted)) continue;
    fit(input, sizes, truth, fitted);
    write_result(fitted);
  }
  return all;
}

}  // namespace rebake
