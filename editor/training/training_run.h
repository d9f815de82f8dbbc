#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <set>

#include "editor/training/reconstruction_options.h"
#include "mesh_ops/base/file_lock.h"
#include "mesh_ops/base/source_guard.h"
#include "mesh_ops/reconstruction/bake_reconstruction.h"
#include "mesh_ops/reconstruction/capture_frame.h"
#include "mesh_ops/reconstruction/reconstruction.h"

namespace rebake {

/// A training of a scene, with checkpoints in a folder beside its result. Going on after an interruption gives the same
/// numbers.
class TrainingRun {
 public:
  using Say = std::function<void(const std::string&)>;

  /// Plans the training, or reads its checkpoint. `work`: folder for the checkpoint, a preview and a table of the
  /// progress; created. `sources`: files that none of them may be. Throws FieldError, FileError, Error for captures
  /// that cannot be trained on, and Cancelled.
  TrainingRun(const ReconstructionOptions& options, Capture capture, const Vec3& background, std::filesystem::path work,
              const SourceGuard& sources, Say say, const Progress& progress);

  /// Trains to the end, or until enough(). If it is cancelled, writes a checkpoint and throws Cancelled.
  void train(const Progress& progress);
  /// Called about every `watch_seconds`, if set.
  std::function<void(TrainingRun&, const Progress&)> watch;
  /// Asked after each step whether to leave out the others, if set.
  std::function<bool()> enough;
  /// Asked, if set, when the training is to stop but its checkpoint cannot be written, with the reason: whether it goes
  /// on instead.
  std::function<bool(const std::string& problem)> goes_on_unsaved;
  double watch_seconds = 20;

  /// Its training photographs are those of reconstruction().
  const Capture& capture() const { return capture_; }
  const CaptureFrame& frame() const { return frame_; }
  const Reconstruction& reconstruction() const { return *reconstruction_; }
  double seconds() const;  ///< time of training, over all interruptions
  /// Whether the last attempt to write a checkpoint succeeded.
  bool is_saved() const { return problem_.empty(); }
  /// Rows of the table of the progress: steps, seconds, PSNR in dB of the training pixels since the row before.
  const std::vector<std::array<double, 3>>& progress_rows() const { return rows_; }
  /// Removes the files of the work folder.
  void remove_work_files();

 private:
  void plan_steps(TrainingPlan& plan, const Progress& progress);
  void open_work_folder(const SourceGuard& sources);
  /// State of train().
  struct Loop {
    double work_before = 0;       ///< work of the steps before this call
    double shown = 0, saved = 0;  ///< seconds since the start at the last preview and checkpoint
    double error = 0;             ///< sum of the errors of `errors` steps since the last preview
    std::size_t errors = 0;
    double psnr = 0;   ///< at the last preview, dB
    std::string text;  ///< of the progress
    double share = 0;  ///< of the progress
  };
  double work_of(std::size_t steps) const;
  void advance(Loop& loop, const Progress& progress);
  bool write_state();
  void show_progress(double mean_error, const Progress& progress);
  void write_or_warn(const char* name, const std::function<void(const std::filesystem::path&)>& write);

  ReconstructionOptions options_;
  Capture capture_;
  CaptureFrame frame_;
  int side_ = 0;  // cells
  std::filesystem::path work_;
  Say say_;
  std::unique_ptr<FileLock> lock_;
  std::unique_ptr<Reconstruction> reconstruction_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  double seconds_before_ = 0;     // time of training in interrupted runs
  std::set<std::string> warned_;  // problems that were said
  std::string problem_;           // why the last checkpoint could not be written; empty: it was written
  std::vector<std::array<double, 3>> rows_;
};

}  // namespace rebake
