#include "editor/gui/state/training_job.h"

#include <fmt/format.h>

#include <chrono>
#include <limits>
#include <new>
#include <utility>

#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/export.h"

namespace rebake {

namespace {

// Not the identifier of any node of a document, which count up from 1.
constexpr auto id_beside = static_cast<NodeId>(std::numeric_limits<std::uint32_t>::max());

constexpr std::chrono::milliseconds between_frames{500};

}  // namespace

TrainingJob::~TrainingJob() {
  closes_ = true;
  cancel_ = true;
  if (thread_.joinable()) thread_.join();
}

void TrainingJob::start(const TrainAction& action) {
  if (state_ != State::none && state_ != State::paused) throw Error("another training is running");
  if (action.out.empty()) throw FieldError("out", "is empty");
  check_can_export(action.out, worker_.snapshot()->sources);
  action_ = action;
  action_.out = absolute_path(action.out).string();
  std::error_code error;
  replaces_ = std::filesystem::exists(action_.out, error) && !std::filesystem::is_empty(action_.out, error);
  preview_ = {};
  node_.reset();
  begin();
}

void TrainingJob::resume() {
  if (state_ == State::paused) begin();
}

void TrainingJob::begin() {
  cancel_ = enough_ = false;
  end_ = End::none;
  status_ = {};
  state_ = State::running;
  thread_ = std::thread([this] { run(); });
}

void TrainingJob::pause() {
  if (state_ != State::running && state_ != State::keeping) return;
  state_ = State::pausing;
  cancel_ = true;
}

void TrainingJob::keep() {
  if (!node_) return;
  resume();
  if (state_ != State::running) return;
  state_ = State::keeping;
  enough_ = true;
}

void TrainingJob::close() {
  if (state_ != State::paused) return;
  state_ = State::none;
  preview_ = {};
  node_.reset();
}

Worker::Status TrainingJob::status() const {
  const std::lock_guard lock(mutex_);
  return status_;
}

void TrainingJob::run() {
  End end = End::done;
  std::string problem;
  try {
    Session session;
    session.progress = Progress(
        [this, woken = std::chrono::steady_clock::time_point()](std::string_view what, double share) mutable {
          {
            const std::lock_guard lock(mutex_);
            status_.what = what;
            status_.share = share;
          }
          // Steps take milliseconds: frames for each would slow the training down.
          const auto now = std::chrono::steady_clock::now();
          if (now - woken < between_frames) return;
          woken = now;
          wake_();
        },
        &cancel_);
    session.say = [this](const std::string& line) {
      const std::lock_guard lock(mutex_);
      messages_.push_back(line);
    };
    TrainingObserver observer;
    observer.enough = [this] { return enough_.load(); };
    observer.may_replace = replaces_;
    observer.more_sources = [this] { return worker_.snapshot()->sources; };
    observer.goes_on_unsaved = [this](const std::string& why) {
      // When the window closes, nobody could free space.
      if (closes_) return false;
      cancel_ = enough_ = false;
      const std::lock_guard lock(mutex_);
      unsaved_ = why;
      return true;
    };
    observer.preview = [this](const TrainingPreview& preview) {
      {
        const std::lock_guard lock(mutex_);
        new_preview_ = preview;
      }
      wake_();
    };
    rebake::run(session, action_, observer);
  } catch (const Cancelled&) {
    end = End::cancelled;
  } catch (const std::bad_alloc&) {
    end = End::failed;
    problem = "not enough memory; a smaller side or smaller photographs need less";
  } catch (const std::exception& error) {
    end = End::failed;
    problem = error.what();
  }
  {
    const std::lock_guard lock(mutex_);
    end_ = end;
    problem_ = problem;
  }
  wake_();
}

std::optional<std::string> TrainingJob::update(Messages& messages) {
  if (!runs()) return {};
  End end{};
  std::optional<TrainingPreview> preview;
  std::string unsaved;
  {
    const std::lock_guard lock(mutex_);
    end = end_;
    preview = std::exchange(new_preview_, std::nullopt);
    unsaved = std::exchange(unsaved_, {});
    for (const std::string& line : std::exchange(messages_, {})) messages.note("Training: " + line);
  }
  if (preview) take(std::move(*preview));
  if (!unsaved.empty()) {
    state_ = State::running;
    messages.fail("The training runs on, because its checkpoint could not be written: " + unsaved +
                  ". Free some space, then pause or keep it again.");
  }
  if (end == End::none) return {};
  thread_.join();
  if (end == End::done) {
    state_ = State::none;
    preview_ = {};
    node_.reset();
    return action_.out;
  }
  state_ = State::paused;
  if (end == End::cancelled)
    messages.say("The training is paused.");
  else
    messages.fail("Training: " + problem_);
  // Without a scene there is nothing to continue.
  if (end == End::failed && !node_) state_ = State::none;
  return {};
}

void TrainingJob::take(TrainingPreview&& preview) {
  preview_ = std::move(preview);
  if (!preview_.object) return;
  auto node = std::make_shared<Node>();
  node->id = id_beside;
  node->name = "training";
  node->object = preview_.object;
  node_ = std::move(node);
}

}  // namespace rebake
