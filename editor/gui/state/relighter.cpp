#include "editor/gui/state/relighter.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "editor/edits/shared_result_cache.h"
#include "mesh_ops/base/error.h"

namespace rebake {

Relighter::Relighter(std::function<void()> wake) : wake_(std::move(wake)), thread_([this] { loop(); }) {}

Relighter::~Relighter() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
    cancel_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

bool Relighter::same(const Wanted& a, const Wanted& b) const {
  // A full request also answers a rough one, and one for a subset of its nodes.
  return a.scene.roots == b.scene.roots && a.scene.light == b.scene.light &&
         (b.rough || (!a.rough && std::includes(a.nodes.begin(), a.nodes.end(), b.nodes.begin(), b.nodes.end())));
}

void Relighter::request(const Scene& scene, bool rough, std::set<NodeId> nodes) {
  {
    const std::lock_guard lock(mutex_);
    Wanted wanted{scene, rough, std::move(nodes)};
    if (asked_ && same(*asked_, wanted)) return;
    asked_ = std::move(wanted);
    wanted_ = asked_;
    if (!scene.light) latest_ = nullptr;
    // During a drag a pass with few rays may finish; otherwise a fast drag would never show a result.
    if (running_ && (!rough || !quick_pass_)) cancel_ = true;
  }
  changed_.notify_all();
}

void Relighter::forget_request() {
  const std::lock_guard lock(mutex_);
  asked_.reset();
}

std::shared_ptr<const Lighting> Relighter::latest() const {
  const std::lock_guard lock(mutex_);
  return latest_;
}

bool Relighter::busy() const {
  const std::lock_guard lock(mutex_);
  return running_ || wanted_.has_value();
}

std::string Relighter::problem() const {
  const std::lock_guard lock(mutex_);
  return problem_;
}

// Publishes light that is rotated with the surfaces dragged since the last full result. False if that does not apply.
bool Relighter::publish_rotated_light(const Scene& scene) {
  if (!start_) return false;
  std::optional<Lighting> turned;
  try {
    turned = dragged_lighting(start_scene_, *start_, scene);
  } catch (const std::exception&) {
    // The traced pass reports the error.
    return false;
  }
  if (!turned) return false;
  const std::lock_guard lock(mutex_);
  if (asked_ && asked_->scene.light) latest_ = std::make_shared<const Lighting>(std::move(*turned));
  return true;
}

void Relighter::loop() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return ending_ || wanted_; });
    if (ending_) return;
    const Wanted next = *std::exchange(wanted_, std::nullopt);
    problem_.clear();
    if (!next.scene.light) {
      start_ = nullptr;
      start_scene_ = {};
      continue;
    }
    running_ = true;
    // A full request with at least twice as many rays gets a quick pass first.
    constexpr int quick = 16;
    const int full = next.scene.light->rays;
    cancel_ = false;
    lock.unlock();
    const bool turned = publish_rotated_light(next.scene);
    lock.lock();
    if (turned) wake_();
    // A newer request has arrived: skips the traced passes.
    if (wanted_ || ending_) {
      running_ = false;
      continue;
    }
    std::vector<int> passes;
    if (!turned && (next.rough || full >= 2 * quick)) passes.push_back(std::min(quick, full));
    if (!next.rough) passes.push_back(full);
    for (const int rays : passes) {
      quick_pass_ = rays < full;
      cancel_ = false;
      lock.unlock();
      std::shared_ptr<const Lighting> made;
      std::string problem;
      try {
        LightingOptions options;
        options.rays = rays;
        // Only full results are cached on disk.
        const std::shared_ptr<ResultCache> results = result_cache();
        options.results = results.get();
        options.keep_traced = rays == full;
        if (!next.rough && rays == full) options.turning = next.nodes;
        made = std::make_shared<const Lighting>(
            lighting_of(next.scene, options, Progress([](std::string_view, double) {}, &cancel_)));
      } catch (const Cancelled&) {
      } catch (const std::exception& error) {
        problem = error.what();
      }
      lock.lock();
      problem_ = problem;
      if (made && !next.rough && rays == full) {
        start_scene_ = next.scene;
        start_ = made;
      }
      // Not published if light was switched off in the meantime.
      if (made && asked_ && asked_->scene.light) latest_ = std::move(made);
      if (!problem.empty()) latest_ = nullptr;
      if (wanted_ || ending_ || !problem.empty()) break;
      wake_();
    }
    running_ = false;
    wake_();
  }
}

}  // namespace rebake
