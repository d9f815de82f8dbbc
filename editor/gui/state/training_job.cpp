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
  cancel_ = true;
  if (thread_.joinable()) thread_.join();
}

void TrainingJob::start(const TrainAction& action) {
  if (state_ != State::none && state_ != State::paused) throw Error("another training is running");
  if (action.out.empty()) throw FieldError("out", "is empty");
  check_can_export(action.out, worker_.snapshot()->sources);
  action_ = action;
  action_.out = absolute_path(action.out).string();
  look_ = {};
  node_.reset();
  go_on();
}

void TrainingJob::go_on() {
  if (thread_.joinable()) thread_.join();
  cancel_ = enough_ = false;
  end_ = End::none;
  status_ = {"training", "", 0};
  state_ = State::running;
  thread_ = std::thread([this] { run(); });
}

void TrainingJob::pause() {
  if (state_ != State::running && state_ != State::keeping) return;
  state_ = State::pausing;
  cancel_ = true;
}

void TrainingJob::keep() {
  if (state_ == State::paused) go_on();
  if (state_ != State::running) return;
  state_ = State::keeping;
  enough_ = true;
}

void TrainingJob::close() {
  if (state_ != State::paused) return;
  state_ = State::none;
  look_ = {};
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
    observer.more_sources = [this] { return worker_.snapshot()->sources; };
    observer.look = [this](const TrainingLook& look) {
      {
        const std::lock_guard lock(mutex_);
        new_look_ = look;
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
  if (state_ == State::none || state_ == State::paused) return {};
  End end{};
  std::optional<TrainingLook> look;
  {
    const std::lock_guard lock(mutex_);
    end = end_;
    look = std::exchange(new_look_, std::nullopt);
    for (const std::string& line : std::exchange(messages_, {})) messages.note("Training: " + line);
  }
  if (look) {
    look_ = std::move(*look);
    if (look_.object) {
      auto node = std::make_shared<Node>();
      node->id = id_beside;
      node->name = "training";
      node->object = look_.object;
      node_ = std::move(node);
    }
  }
  if (end == End::none) return {};
  thread_.join();
  if (end == End::done) {
    state_ = State::none;
    node_.reset();
    return action_.out;
  }
  state_ = State::paused;
  if (end == End::failed) {
    messages.fail("Training: " + problem_);
    if (!node_) state_ = State::none;
  } else {
    messages.say("The training is paused; its checkpoint is in " + action_.out + ".training.");
  }
  return {};
}

}  // namespace rebake
