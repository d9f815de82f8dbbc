#include "editor/studies/representations/fitted_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <nlohmann/json.hpp>
#include <optional>

#include "editor/studies/representations/marched_volume.h"
#include "editor/studies/representations/plenoctree_files.h"
#include "editor/studies/representations/plenoctree_fit.h"
#include "editor/studies/representations/snerg_files.h"
#include "editor/studies/representations/snerg_fit.h"
#include "editor/training/checkpoint.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/export.h"
#include "render/compare.h"
#include "samples/bakery/bake.h"

namespace rebake {

namespace fs = std::filesystem;
using Method = FittedFiles::Method;
using Clock = std::chrono::steady_clock;

namespace {

constexpr double enough_db = 0.2;  // a doubling that gains less is the last
constexpr int first_epochs = 10, most_epochs = 160;
constexpr int validation_views = 2;
// Changes when fits do: earlier results are then made again.
constexpr int fit_version = 3;

double mean_psnr(const std::vector<HeldOutView>& views, const std::function<Image(const View&)>& draw) {
  double sum = 0;
  for (const HeldOutView& one : views) sum += compare(draw(one.view), one.truth, 2).psnr_db;
  return sum / static_cast<double>(views.size());
}

// Minutes of all processors that this process has used; other programs do not count.
double processor_minutes() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC / 60; }

// Measures the curve of a fit during the fit.
class Budget {
 public:
  Budget(const StudyInput& input, FittedFiles& fitted, std::vector<HeldOutView> views, int most)
      : input_(input), fitted_(fitted), views_(std::move(views)), most_(most) {
    for (const auto& [passes, db] : fitted.curve) best_ = std::max(best_, db);
  }

  // Whether to double `passes`. `better`: called if no earlier result was as good.
  bool goes_on(int passes, const std::function<Image(const View&)>& draw, const std::function<void()>& better) {
    const double start = processor_minutes();
    const double now = mean_psnr(views_, draw);
    const double gain = fitted_.curve.empty() ? std::numeric_limits<double>::infinity() : now - fitted_.curve.back()[1];
    if (now > best_) {
      best_ = now;
      better();
    }
    measuring_ += processor_minutes() - start;
    fitted_.curve.push_back({static_cast<double>(passes), now});
    fitted_.passes = passes;
    input_.say(fmt::format("{}, {}: {:.2f} dB after {} {}", fitted_.sample, fitted_.name, now, passes,
                           fitted_.method == Method::mobilenerf ? "epochs" : "passes"));
    if (gain >= enough_db && 2 * passes > most_)
      input_.say(
          fmt::format("warning: {}, {}: the last doubling still gained {:.2f} dB", fitted_.sample, fitted_.name, gain));
    return gain >= enough_db && 2 * passes <= most_;
  }
  template <class Volume>
  bool goes_on_with(int passes, const Volume& volume, const std::function<void(const Volume&)>& write) {
    MarchedVolume drawing(volume, input_.renderer().context());
    return goes_on(
        passes, [&](const View& view) { return drawing.picture(view); }, [&] { write(volume); });
  }
  double minutes_of_measuring() const { return measuring_; }
  /// Does something that is no part of the fit.
  void do_apart(const std::function<void()>& work) {
    const double start = processor_minutes();
    work();
    measuring_ += processor_minutes() - start;
  }

 private:
  const StudyInput& input_;
  FittedFiles& fitted_;
  std::vector<HeldOutView> views_;
  int most_;
  double best_ = -std::numeric_limits<double>::infinity(), measuring_ = 0;
};

Scene scene_of(const std::shared_ptr<const BakedObject>& object) {
  Node node;
  node.object = object;
  return with_added({}, std::move(node), NodeId::none, 0);
}

void fit_mobilenerf(const StudyInput& input, const RepresentationSizes& sizes, SampleTruth& truth, FittedFiles& fitted,
                    Budget& budget) {
  std::shared_ptr<const BakedObject> best;
  for (int epochs = first_epochs;; epochs *= 2) {
    const double start = processor_minutes();
    const auto object = bakery::bake(
        truth.model(), truth.field(),
        {.epochs = epochs, .observations = sizes.views, .texels_per_side = fitted.resolution}, input.progress);
    const Scene scene = scene_of(object);
    fitted.minutes = processor_minutes() - start;
    if (budget.goes_on(
            epochs, [&](const View& view) { return input.renderer().render(scene, view); }, [&] { best = object; }))
      continue;
    export_scene(scene_of(best), fitted.folder / "baked", {}, input.progress);
    return;
  }
}

int most_passes_of(const RepresentationSizes& sizes, Method method) {
  return method == Method::mobilenerf ? most_epochs : sizes.most_passes;
}

std::string text_of(const RepresentationSizes& sizes) {
  return fmt::format("version {}, {} views of {}² rays, pictures of {}²", fit_version, sizes.views, sizes.ray_side,
                     sizes.picture);
}

// The folder without the pictures of a worse result, which may have more of them. Throws FileError if it holds anything
// that the study did not write.
fs::path fresh_folder(const fs::path& folder) {
  constexpr const char* own[] = {"scene_params.json", "tree.npz"};
  fs::create_directories(folder);
  std::vector<fs::path> old;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const fs::path& file = entry.path();
    const std::string name = file.filename().string();
    if (std::find(std::begin(own), std::end(own), name) != std::end(own)) continue;
    const bool left =
        std::any_of(std::begin(own), std::end(own), [&](const char* one) { return is_partial_of(name, one); });
    if (!left && !is_rendered_picture(file))
      throw FileError(file,
                      "was not written by the study, was changed since, or is of an earlier build; move it elsewhere");
    old.push_back(file);
  }
  for (const fs::path& file : old) fs::remove(file);
  return folder;
}
void write_best(const FittedFiles& fitted, const SnergScene& best) {
  write_snerg(best, fresh_folder(fitted.folder / "baked"), {});
}
void write_best(const FittedFiles& fitted, const PlenOctree& best) {
  write_plenoctree(best, fresh_folder(fitted.folder / "baked") / "tree.npz", {});
  write_quantised_plenoctree(best, fresh_folder(fitted.folder / "web") / "tree.npz", {});
}

fs::path checkpoint_of(const FittedFiles& fitted) { return fitted.folder / "checkpoint"; }

nlohmann::json head_of(const RepresentationSizes& sizes, const FittedFiles& fitted, int passes) {
  return {{"sizes", text_of(sizes)}, {"minutes", fitted.minutes}, {"passes", passes}, {"curve", fitted.curve}};
}

// The state of an interrupted fit of these sizes, whose curve and minutes `fitted` then has.
FitCheckpoints interrupted_fit(const RepresentationSizes& sizes, FittedFiles& fitted) {
  FitCheckpoints checkpoints;
  try {
    nlohmann::json head;
    const std::optional<std::string> state = read_checkpoint(checkpoint_of(fitted), head);
    if (!state || head.at("sizes") != text_of(sizes)) return checkpoints;
    fitted.minutes = head.at("minutes");
    fitted.curve = head.at("curve").get<std::vector<std::array<double, 2>>>();
    fitted.passes = fitted.curve.empty() ? 0 : static_cast<int>(fitted.curve.back()[0]);
    checkpoints.start = FitCheckpoints::State{head.at("passes"), *state};
  } catch (const std::exception&) {
    throw FileError(checkpoint_of(fitted), "is damaged; remove it to fit this representation from the start");
  }
  return checkpoints;
}

void fit(const StudyInput& input, const RepresentationSizes& sizes, SampleTruth& truth, FittedFiles& fitted) {
  FitCheckpoints checkpoints = interrupted_fit(sizes, fitted);
  if (checkpoints.start)
    input.say(fmt::format("{}, {}: goes on after {} passes", fitted.sample, fitted.name, checkpoints.start->passes));
  // The files that it describes are about to change.
  std::error_code error;
  fs::remove(fitted.folder / "fit.json", error);
  std::vector<HeldOutView> views = truth.validation(fitted.folder.parent_path());
  const bool epochs = fitted.method == Method::mobilenerf;
  Budget budget(input, fitted, std::move(views), most_passes_of(sizes, fitted.method));
  fs::create_directories(fitted.folder);
  if (epochs) {
    truth.field();
    return fit_mobilenerf(input, sizes, truth, fitted, budget);
  }
  truth.rays();  // before time counts
  const double start = processor_minutes() - fitted.minutes;
  const auto minutes = [&] { return processor_minutes() - start - budget.minutes_of_measuring(); };
  checkpoints.keep = [&, kept = Clock::now()](int passes, const std::function<std::string()>& state) mutable {
    // Often enough that little is lost, and at the end of each doubling, whose result is then on disk.
    if (passes != fitted.passes && Clock::now() - kept < std::chrono::minutes(2)) return;
    fitted.minutes = minutes();
    budget.do_apart([&] { write_checkpoint(checkpoint_of(fitted), head_of(sizes, fitted, passes), state()); });
    kept = Clock::now();
  };
  if (fitted.method == Method::snerg)
    fit_snerg(
        truth.rays(), fitted.resolution,
        [&](int passes, const SnergScene& now) {
          return budget.goes_on_with<SnergScene>(passes, now, [&](const auto& best) { write_best(fitted, best); });
        },
        input.progress, checkpoints);
  else
    fit_plenoctree(
        truth.rays(), fitted.resolution,
        [&](int passes, const PlenOctree& now) {
          return budget.goes_on_with<PlenOctree>(passes, now, [&](const auto& best) { write_best(fitted, best); });
        },
        input.progress, checkpoints);
  fitted.minutes = minutes();
}

// Whether a fit ended at an earlier limit of passes, although it gained from each doubling and may have more now.
bool may_gain_more(const RepresentationSizes& sizes, const FittedFiles& fitted) {
  const auto& curve = fitted.curve;
  const bool gained = curve.size() < 2 || curve.back()[1] - curve[curve.size() - 2][1] >= enough_db;
  return gained && 2 * fitted.passes <= most_passes_of(sizes, fitted.method);
}

// The result of fit(); written last, so that an interrupted fit goes on.
void write_result(const RepresentationSizes& sizes, const FittedFiles& fitted) {
  const nlohmann::json result{
      {"sizes", text_of(sizes)}, {"minutes", fitted.minutes}, {"passes", fitted.passes}, {"curve", fitted.curve}};
  write_file_atomically(fitted.folder / "fit.json", result.dump(), {});
  std::error_code error;
  fs::remove(checkpoint_of(fitted), error);
}

bool read_result(const RepresentationSizes& sizes, FittedFiles& fitted) {
  std::error_code error;
  const fs::path file = fitted.folder / "fit.json";
  if (!fs::is_regular_file(file, error)) return false;
  try {
    const nlohmann::json result = nlohmann::json::parse(read_file(file));
    if (result.at("sizes") != text_of(sizes)) return false;
    fitted.minutes = result.at("minutes");
    fitted.passes = result.at("passes");
    fitted.curve = result.at("curve").get<std::vector<std::array<double, 2>>>();
  } catch (const nlohmann::json::exception&) {
    throw FileError(file, "is damaged; remove its folder to fit this representation again");
  }
  return !may_gain_more(sizes, fitted);
}

}  // namespace

SampleTruth::SampleTruth(const std::string& sample, const RepresentationSizes& sizes, const Progress& progress)
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
  return traced(held_out_views(model_, sizes_.held_out, sizes_.picture), folder, "truth");
}

std::vector<HeldOutView> SampleTruth::validation(const fs::path& folder) {
  return traced(held_out_views(model_, validation_views, sizes_.picture, 1), folder, "validation");
}

std::vector<HeldOutView> SampleTruth::traced(std::vector<HeldOutView> views, const fs::path& folder,
                                             const std::string& name) {
  std::error_code error;
  fs::create_directories(folder);
  for (std::size_t k = 0; k < views.size(); ++k) {
    HeldOutView& one = views[k];
    const fs::path file = folder / fmt::format("{}-{}-{}.png", name, sizes_.picture, k);
    if (fs::is_regular_file(file, error)) {
      one.truth = read_image(file);
      continue;
    }
    progress_.at("tracing held-out views", static_cast<double>(k) / static_cast<double>(views.size()));
    one.truth = field().trace(one.view.camera, one.view.width, one.view.height);
    write_picture(one.truth, file, {});
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
    if (read_result(sizes, fitted)) continue;
    fitted.curve.clear();
    fitted.minutes = 0;
    fit(input, sizes, truth, fitted);
    write_result(sizes, fitted);
  }
  return all;
}

}  // namespace rebake
