#include "editor/gui/state/previews.h"

#include <new>
#include <utility>

#include "mesh_ops/base/error.h"

namespace rebake {

Previews::Previews(std::function<void()> wake) : wake_(std::move(wake)), thread_([this] { loop(); }) {}

Previews::~Previews() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
    cancel_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

std::size_t Previews::request(std::vector<NodePtr> of, Make make, Make exact) {
  std::size_t number = 0;
  {
    const std::lock_guard lock(mutex_);
    number = ++requests_;
    wanted_ = Wanted{std::move(of), std::move(make), std::move(exact), number};
    if (refining_) cancel_ = true;
  }
  changed_.notify_all();
  return number;
}

void Previews::set_prepare(std::function<void(const Scene&)> prepare) {
  const std::lock_guard lock(prepare_mutex_);
  prepare_ = std::move(prepare);
}

void Previews::drop_stale() {
  const std::lock_guard lock(mutex_);
  if (running_ && wanted_) cancel_ = true;
}

void Previews::drop() {
  const std::lock_guard lock(mutex_);
  wanted_.reset();
  made_.reset();
  if (running_) cancel_ = true;
}

std::size_t Previews::requests() const {
  const std::lock_guard lock(mutex_);
  return requests_;
}

bool Previews::busy() const {
  const std::lock_guard lock(mutex_);
  return running_ || wanted_.has_value();
}

std::string Previews::problem() const {
  const std::lock_guard lock(mutex_);
  return problem_;
}

std::optional<Preview> Previews::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(made_, std::nullopt);
}

void Previews::make(std::unique_lock<std::mutex>& lock, const Wanted& wanted, const Make& make) {
  cancel_ = false;
  lock.unlock();
  std::optional<Preview> made;
  std::string problem;
  try {
    made = Preview{make(Progress([](std::string_view, double) {}, &cancel_)), wanted.of, wanted.number};
    const std::lock_guard ready(prepare_mutex_);
    if (prepare_) prepare_(made->scene);
  } catch (const Cancelled&) {
    // A newer request follows.
  } catch (const std::exception& error) {
    // Only forms show it: applying the edits fails with the same error.
    problem = error.what();
  }
  lock.lock();
  problem_ = problem;
  if (made && !cancel_) made_ = std::move(made);
}

void Previews::loop() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return ending_ || wanted_; });
    if (ending_) return;
    const Wanted next = *std::exchange(wanted_, std::nullopt);
    running_ = true;
    make(lock, next, next.make);
    if (next.exact && !wanted_ && !cancel_ && !ending_) {
      refining_ = true;
      wake_();
      make(lock, next, next.exact);
      refining_ = false;
    }
    running_ = false;
    wake_();
  }
}

}  // namespace rebake
