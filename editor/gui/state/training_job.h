#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "editor/actions/train.h"
#include "editor/gui/state/messages.h"
#include "editor/gui/state/worker.h"
#include "mesh_ops/scene/scene.h"

namespace rebake {

/// A training of a scene from photographs beside the document, on a thread of its own. Pausing it writes a checkpoint
/// and frees its memory; so does closing the window.
class TrainingJob {
 public:
  enum class State { none, running, pausing, keeping, paused };

  /// The worker must outlive this object. `wake` makes the window draw a frame; it is called from other threads.
  TrainingJob(const Worker& worker, std::function<void()> wake) : worker_(worker), wake_(std::move(wake)) {}
  /// Pauses and waits.
  ~TrainingJob();
  TrainingJob(const TrainingJob&) = delete;
  TrainingJob& operator=(const TrainingJob&) = delete;

  /// Starts a training, if none is running. Throws Error if its output folder may not be written.
  void start(const TrainAction& action);
  /// Stops at a checkpoint. If none can be written, the training runs on.
  void pause();
  /// Continues a paused training from its checkpoint.
  void resume();
  /// Leaves out the rest of the steps and writes the scene as it is. Only if there is a node().
  void keep();
  /// Forgets a paused training. Its checkpoint stays: the same training continues from there.
  void close();

  State state() const { return state_; }
  /// Whether its thread runs.
  bool runs() const { return state_ != State::none && state_ != State::paused; }
  const TrainAction& action() const { return action_; }
  /// Current task and its completed share, 0 … 1.
  Worker::Status status() const;
  /// Steps, seconds and PSNR of the training pixels in dB, in the order of the steps.
  const std::vector<std::array<double, 3>>& progress_rows() const { return preview_.rows; }
  /// The scene so far, as a node that is not part of a document; null: nothing to see yet.
  const NodePtr& node() const { return node_; }
  const std::vector<PhotoCamera>& cameras() const { return preview_.cameras; }

  /// Takes preview and messages from the thread. Returns the folder of the scene when the training is done.
  std::optional<std::string> update(Messages& messages);

 private:
  void run();
  void begin();
  void take(TrainingPreview&& preview);

  const Worker& worker_;
  std::function<void()> wake_;
  State state_ = State::none;
  TrainAction action_;
  bool replaces_ = false;  ///< the output folder had contents when the user started the training
  TrainingPreview preview_;
  NodePtr node_;

  /// How the thread has ended.
  enum class End { none, done, cancelled, failed };
  mutable std::mutex mutex_;
  Worker::Status status_;  // the following members belong to the mutex
  std::vector<std::string> messages_;
  std::optional<TrainingPreview> new_preview_;
  End end_ = End::none;
  std::string problem_;
  std::string unsaved_;  // why a checkpoint could not be written when the training was to stop; empty: none
  std::atomic<bool> cancel_ = false, enough_ = false, closes_ = false;
  std::thread thread_;
};

}  // namespace rebake
