#include "editor/gui/window/worker.h"

#include <fmt/format.h>

#include <filesystem>
#include <new>
#include <utility>

#include "mesh_ops/index/index.h"

namespace rebake {

Worker::Worker(std::function<void()> wake) : wake_(std::move(wake)) {
  session_.progress = Progress(
      [this](std::string_view what, double share) {
        {
          const std::lock_guard lock(mutex_);
          status_.what = what;
          status_.share = share;
        }
        wake_();
      },
      &cancel_);
  session_.say = [this](const std::string& line) {
    const std::lock_guard lock(mutex_);
    messages_.push_back({line, false});
  };
  thread_ = std::thread([this] { loop(); });
}

Worker::~Worker() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
    waiting_.clear();
    cancel_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void Worker::start(std::string title, Job job, std::function<void()> then, std::function<void()> otherwise) {
  {
    const std::lock_guard lock(mutex_);
    waiting_.push_back({std::move(title), std::move(job), std::move(then), std::move(otherwise)});
  }
  changed_.notify_all();
}

bool Worker::busy() const {
  const std::lock_guard lock(mutex_);
  return running_ || !waiting_.empty();
}

void Worker::cancel() {
  {
    const std::lock_guard lock(mutex_);
    for (Waiting& forgotten : waiting_)
      if (forgotten.otherwise) finished_.push_back(std::move(forgotten.otherwise));
    waiting_.clear();
    if (running_) cancel_ = true;
  }
  wake_();
}

Worker::Status Worker::status() const {
  const std::lock_guard lock(mutex_);
  return status_;
}

std::shared_ptr<const Snapshot> Worker::snapshot() const {
  const std::lock_guard lock(mutex_);
  return snapshot_;
}

std::vector<Worker::Message> Worker::take_messages() {
  const std::lock_guard lock(mutex_);
  return std::exchange(messages_, {});
}

std::vector<std::function<void()>> Worker::take_finished() {
  const std::lock_guard lock(mutex_);
  return std::exchange(finished_, {});
}

void Worker::publish() {
  auto next = std::make_shared<Snapshot>();
  const History& history = session_.document.history();
  next->scene = history.now();
  next->done = history.edits();
  next->undone = history.undone();
  next->joined = history.joined();
  next->sources = session_.document.sources();
  next->history_bytes = history.memory();
  const std::lock_guard lock(mutex_);
  snapshot_ = std::move(next);
}

void Worker::loop() {
  for (;;) {
    Waiting next;
    {
      std::unique_lock lock(mutex_);
      running_ = false;
      status_ = {};
      changed_.wait(lock, [this] { return ending_ || !waiting_.empty(); });
      if (ending_) break;
      next = std::move(waiting_.front());
      waiting_.pop_front();
      running_ = true;
      cancel_ = false;
      status_.title = next.title;
    }
    std::string failed;
    const std::size_t before = session_.document.history().undo_count();
    if (drops_renderer_.exchange(false)) session_.drop_renderer();
    try {
      next.job(session_);
    } catch (const Cancelled&) {
      failed = next.title + ": stopped";
    } catch (const std::filesystem::filesystem_error& error) {
      failed = next.title + ": " + error.path1().string() + ": " + error.code().message();
    } catch (const std::bad_alloc&) {
      failed = next.title + ": memory is out";
    } catch (const std::exception& error) {
      failed = next.title + ": " + error.what();
    }
    if (!failed.empty() && session_.document.history().undo_count() != before)
      failed += " (what was done before stays, and can be undone)";
    publish();
    {
      const std::lock_guard lock(mutex_);
      if (!failed.empty()) messages_.push_back({failed, true});
      if (std::function<void()>& after = failed.empty() ? next.then : next.otherwise)
        finished_.push_back(std::move(after));
      if (waiting_.empty()) {
        running_ = false;
        status_ = {};
      }
    }
    wake_();
    // What picking wants to know, while nothing else is to be done.
    try {
      for (const PlacedNode& placed : placed_nodes(session_.scene())) {
        if (busy()) break;
        if (placed.node->object) rays_of(*placed.node->object);
      }
    } catch (const std::exception&) {
      // Picking says what is wrong when it wants it.
    }
  }
  // Where it was made, its context is current.
  session_.drop_renderer();
}

}  // namespace rebake
