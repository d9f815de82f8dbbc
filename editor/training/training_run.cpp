#include "editor/training/training_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "editor/training/checkpoint.h"
#include "editor/training/training_judgement.h"
#include "mesh_ops/base/duration.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "render/contact_sheet.h"
#include "render/image.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

constexpr double seconds_between_checkpoints = 60;
constexpr const char *checkpoint_name = "rebake-checkpoint", *preview_name = "rebake-preview.png",
                     *table_name = "rebake-progress.csv", *lock_name = "rebake-lock";
constexpr const char* table_header = "steps,seconds,PSNR of training pixels dB\n";
constexpr int preview_side = 96;  // pixels at most: it must take less than a second

// Whether a file of a work folder has the name and the beginning of one that a training made there.
bool has_own_content(const fs::directory_entry& entry) {
  const std::string name = entry.path().filename().string();
  std::error_code error;
  const char* const own[] = {checkpoint_name, preview_name, table_name, lock_name};
  if (std::none_of(std::begin(own), std::end(own),
                   [&](const char* one) { return name == one || is_partial_of(name, one); }))
    return false;
  if (!entry.is_regular_file(error) || entry.file_size(error) == 0) return true;
  // A killed run leaves the part that it has written.
  if (std::none_of(std::begin(own), std::end(own), [&](const char* one) { return name == one; })) return true;
  if (name == preview_name) return is_rendered_picture(entry.path());
  if (name == table_name) return read_file(entry.path()).starts_with(table_header);
  return name == checkpoint_name && is_checkpoint(entry.path());
}

// Whether an entry of a work folder is a file that a training made there, and no link to another file.
bool is_own(const fs::directory_entry& entry) {
  std::error_code error;
  if (entry.is_symlink(error) || (entry.is_regular_file(error) && entry.hard_link_count(error) > 1)) return false;
  return has_own_content(entry);
}

// Throws FileError if something else was put there during the training. Hard links are copies of backups: writing
// leaves the others as they are.
void refuse_foreign(const fs::path& file) {
  std::error_code error;
  if (fs::is_symlink(file, error) || (fs::exists(file, error) && !has_own_content(fs::directory_entry(file, error))))
    throw FileError(file, "is not what the training wrote there, so it is kept");
}

// Cells per side that suit the photographs: half a cell per pixel, from small ones to the published grid.
int side_for(const std::vector<FitPhotograph>& photographs) {
  std::vector<int> heights;
  for (const FitPhotograph& one : photographs) heights.push_back(std::min(one.width, one.height));
  std::nth_element(heights.begin(), heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2), heights.end());
  return std::clamp(heights[heights.size() / 2] / 2 / 16 * 16, 32, 128);
}

CaptureFrame frame_of(const ReconstructionOptions& options, const Capture& capture, const Vec3& background, int side) {
  constexpr double free_cells = 2;
  if (options.kind == CaptureKind::object) return object_frame(capture.training, background, free_cells / side);
  if (options.kind == CaptureKind::unbounded) return unbounded_frame(capture.training);
  return forward_frame(capture.training, options.near.value_or(0), options.far.value_or(0));
}

const char* name_of(TrainingStage stage) {
  return stage == TrainingStage::soft ? "stage 1" : stage == TrainingStage::binary ? "stage 2" : "stage 2, features";
}

}  // namespace

TrainingRun::TrainingRun(const ReconstructionOptions& options, Capture capture, const Vec3& background, fs::path work,
                         const SourceGuard& sources, Say say, const Progress& progress)
    : options_(options), capture_(std::move(capture)), work_(std::move(work)), say_(std::move(say)) {
  check(options_);
  side_ = options_.side.value_or(side_for(capture_.training));
  frame_ = frame_of(options_, capture_, background, side_);
  for (const std::string& note : frame_.notes) say_(note);
  std::size_t pixels = 0;
  for (const FitPhotograph& one : capture_.training) pixels += one.valid.size();
  TrainingPlan plan = plan_for(options_.kind, side_, pixels, static_cast<std::uint64_t>(options_.seed));
  plan.to_unit = frame_.to_unit;
  plan.frustum = frame_.frustum;
  plan.gains = options_.gains && capture_.training.size() > 1;
  plan.four_rays = options_.four_rays;
  plan.mlp = options_.mlp;
  plan.width = options_.width;
  plan.octaves = options_.octaves;
  plan.layers = options_.layers;
  if (plan.gains && !frame_.gains.empty())
    say_("exposures: the backgrounds of the photographs differ in brightness, so each photograph has a gain");
  open_work_folder(sources);
  nlohmann::json head;
  std::optional<std::string> state;
  if (!options_.fresh) state = read_checkpoint(work_ / checkpoint_name, head);
  try {
    if (state) {
      if (head.at("options") != identity_of(options_, side_) || head.at("photographs") != capture_.hash)
        throw FileError(work_,
                        "holds the checkpoint of a training with other options or photographs; use the same ones, "
                        "another folder, or start again with fresh (--fresh)");
      const std::vector<std::size_t> steps = head.at("steps");
      std::tie(plan.open_steps, plan.soft_steps, plan.binary_steps, plan.feature_steps) =
          std::tuple(steps.at(0), steps.at(1), steps.at(2), steps.at(3));
    } else {
      plan_steps(plan, progress);
    }
    for (const std::string& line : words_of(plan)) say_("plan: " + line);
    TrainingViews views(std::move(capture_.training), plan.to_unit, trained_axes);
    reconstruction_ = std::make_unique<Reconstruction>(plan, std::move(views), frame_.background, fields_of(plan));
    if (plan.gains && !frame_.gains.empty()) reconstruction_->start_with_gains(frame_.gains);
    if (state) {
      reconstruction_->load(*state);
      seconds_before_ = head.at("seconds");
      rows_ = head.at("rows");
      say_(fmt::format("goes on from step {} of {}", reconstruction_->steps_done(), plan.steps()));
    } else {
      write_state();  // of step 0: replaces an earlier checkpoint, and keeps the number of steps
    }
  } catch (const nlohmann::json::exception&) {
    throw FileError(work_ / checkpoint_name, "is damaged; start again with fresh (--fresh)");
  }
}

// Creates and locks the folder for checkpoints. Other files in it stay safe, as do sources of the run and files of the
// same names that another program made.
void TrainingRun::open_work_folder(const SourceGuard& sources) {
  for (const char* name : {checkpoint_name, preview_name, table_name, lock_name}) sources.check_file(work_ / name);
  std::error_code error;
  fs::create_directories(work_, error);
  if (error) throw FileError(work_, "cannot be created: " + error.message());
  for (const auto& entry : fs::directory_iterator(work_))
    if (const std::string name = entry.path().filename().string(); !is_own(entry))
      throw FileError(work_, "holds \"" + name + "\", which is no file of a training; choose another output folder");
  lock_ = std::make_unique<FileLock>(work_ / lock_name);
  if (!lock_->held()) throw FileError(work_, "is in use by another training to the same folder");
}

// Sets the number of steps: as usual, as given, or by time.
void TrainingRun::plan_steps(TrainingPlan& plan, const Progress& progress) {
  if (options_.steps) {
    plan = with_steps(plan, *options_.steps);
    constexpr double rounding = 1.02;
    if (static_cast<double>(plan.steps()) > rounding * *options_.steps)
      say_(fmt::format("warning: this grid needs at least {} steps, more than {}; a smaller side needs fewer",
                       plan.steps(), *options_.steps));
  }
  if (!options_.minutes) return;
  progress.at("measuring the time of a step", 0);
  Reconstruction trial(plan, TrainingViews(capture_.training, plan.to_unit, trained_axes), frame_.background,
                       fields_of(plan));
  std::vector<double> times;
  constexpr int trials = 7;
  for (int k = 0; k < trials; ++k) {
    const auto start = std::chrono::steady_clock::now();
    trial.step();
    times.push_back(seconds_since(start));
  }
  std::nth_element(times.begin(), times.begin() + trials / 2, times.end());
  constexpr double share_of_training = 0.9;  // the rest bakes and compares
  const double open_steps = share_of_training * 60 * *options_.minutes / times[trials / 2];
  plan = with_steps(plan, static_cast<double>(plan.steps()) * open_steps / open_steps_of_time(plan));
  constexpr double much = 1.2;
  if (open_steps_of_time(plan) > much * open_steps)
    say_(fmt::format("warning: this grid needs about {}; a smaller side needs less",
                     duration_text(open_steps_of_time(plan) * times[trials / 2] / share_of_training)));
}

double TrainingRun::seconds() const { return seconds_before_ + seconds_since(start_); }

bool TrainingRun::write_state() {
  const TrainingPlan& plan = reconstruction_->plan();
  const nlohmann::json head = {{"options", identity_of(options_, side_)},
                               {"photographs", capture_.hash},
                               {"steps", {plan.open_steps, plan.soft_steps, plan.binary_steps, plan.feature_steps}},
                               {"seconds", seconds()},
                               {"rows", rows_}};
  try {
    refuse_foreign(work_ / checkpoint_name);
    write_checkpoint(work_ / checkpoint_name, head, reconstruction_->save());
    problem_.clear();
    return true;
  } catch (const FileError& error) {
    problem_ = error.what();
    say_(fmt::format("warning: the checkpoint could not be written: {}", problem_));
    return false;
  }
}

// Writes a file that the training does not need. Says each problem once.
void TrainingRun::write_or_warn(const char* name, const std::function<void(const fs::path&)>& write) {
  try {
    refuse_foreign(work_ / name);
    write(work_ / name);
  } catch (const FileError& error) {
    if (warned_.insert(error.what()).second) say_(fmt::format("warning: {}", error.what()));
  }
}

// A row of the table, and a picture of the scene beside a photograph.
void TrainingRun::show_progress(double mean_error, const Progress& progress) {
  rows_.push_back({static_cast<double>(reconstruction_->steps_done()), seconds(), decibels_of(mean_error)});
  std::string table = table_header;
  for (const auto& [steps, seconds, psnr] : rows_) table += fmt::format("{:.0f},{:.1f},{:.3f}\n", steps, seconds, psnr);
  const FitPhotograph photograph = reduced(reconstruction_->views().photographs().front(), preview_side);
  const Image wanted{photograph.width, photograph.height, photograph.rgb, {}};
  write_or_warn(table_name, [&](const fs::path& file) { write_file_atomically(file, table, {}); });
  write_or_warn(preview_name, [&](const fs::path& file) {
    write_picture(
        contact_sheet({wanted, trained_picture(*reconstruction_, photograph, progress)}, 2, 4, {128, 128, 128}), file,
        {});
  });
  if (watch) watch(*this, progress);
}

// Work of the first steps; counted in steps without empty cells left out.
double TrainingRun::work_of(std::size_t steps) const {
  TrainingPlan part = reconstruction_->plan();
  const auto take = [&](std::size_t& count) {
    count = std::min(count, steps);
    steps -= count;
  };
  std::size_t culled = part.soft_steps - part.open_steps;
  take(part.open_steps);
  take(culled);
  part.soft_steps = part.open_steps + culled;
  take(part.binary_steps);
  take(part.feature_steps);
  return open_steps_of_time(part);
}

// One step, then whichever of these is due: checkpoint, preview, messages, progress.
void TrainingRun::advance(Loop& loop, const Progress& progress) {
  const TrainingStage stage = reconstruction_->stage();
  loop.error += reconstruction_->step();
  ++loop.errors;
  const double now = seconds_since(start_);
  const std::size_t done = reconstruction_->steps_done(), total = reconstruction_->plan().steps();
  const bool ends_stage = reconstruction_->stage() != stage;
  // Before the preview, which may take a moment in which the program can be stopped.
  if (ends_stage || now - loop.saved > seconds_between_checkpoints) {
    write_state();
    loop.saved = seconds_since(start_);
  }
  constexpr double until_first_preview = 5;
  if (ends_stage || now - loop.shown > watch_seconds || (loop.shown == 0 && now > until_first_preview)) {
    loop.shown = now;
    const double error = loop.error / static_cast<double>(loop.errors);
    loop.psnr = decibels_of(error);
    // Keeps the text of the progress.
    show_progress(error, Progress([&](std::string_view, double) { progress.at(loop.text, loop.share); }));
    loop.error = 0;
    loop.errors = 0;
  }
  if (ends_stage)
    say_(fmt::format("{} done after {}: {:.2f} dB on training pixels", name_of(stage), duration_text(seconds()),
                     loop.psnr));
  if (ends_stage && stage == TrainingStage::soft && reconstruction_->plan().gains)
    say_(reconstruction_->has_gains() ? fmt::format("exposures differ by {:.0f} %: each photograph has a gain",
                                                    100 * reconstruction_->exposure_spread())
                                      : std::string("exposures agree: no gains"));
  const double work = work_of(done), more = work - loop.work_before, all = work_of(total);
  const std::string rest = more > 10 ? about + remaining_text((all - work) * now / more) : std::string();
  loop.text = fmt::format("training {}{}{}, step {} of {}", name_of(stage), rest,
                          loop.psnr > 0 ? fmt::format(", {:.1f} dB", loop.psnr) : "", done, total);
  loop.share = 0.95 * work / all;
  progress.at(loop.text, loop.share);
}

void TrainingRun::train(const Progress& progress) {
  start_ = std::chrono::steady_clock::now();
  Loop loop;
  loop.work_before = work_of(reconstruction_->steps_done());
  const std::size_t total = reconstruction_->plan().steps();
  // Whether the training may stop here. Without a checkpoint all of its work would be lost.
  const auto may_stop = [&] { return write_state() || !goes_on_unsaved || !goes_on_unsaved(problem_); };
  while (reconstruction_->stage() != TrainingStage::done) {
    try {
      advance(loop, progress);
    } catch (const Cancelled&) {
      if (!may_stop()) continue;
      say_(fmt::format("stopped at step {} of {}; the same command goes on from {}", reconstruction_->steps_done(),
                       total, is_saved() ? "there" : "the last checkpoint, if there is one"));
      throw;
    }
    if (enough && enough() && may_stop()) {
      say_(fmt::format("ends early, after step {} of {}", reconstruction_->steps_done(), total));
      return;
    }
  }
}

void TrainingRun::remove_work_files() {
  std::error_code error;
  for (const char* name : {checkpoint_name, preview_name, table_name, lock_name})
    if (const fs::directory_entry entry(work_ / name, error); entry.exists(error) && is_own(entry))
      fs::remove(entry.path(), error);
  if (!fs::is_symlink(work_, error)) fs::remove(work_, error);  // stays if it holds other files
}

}  // namespace rebake
