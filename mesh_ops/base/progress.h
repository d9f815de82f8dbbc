#pragma once

#include <atomic>
#include <functional>
#include <string_view>

#include "mesh_ops/base/error.h"

namespace rebake {

/// Carries progress out of long work and the wish to stop into it. A default-constructed one does neither.
class Progress {
 public:
  using Report = std::function<void(std::string_view what, double share_done)>;

  Progress() = default;
  explicit Progress(Report report, const std::atomic<bool>* cancel = nullptr)
      : report_(std::move(report)), cancel_(cancel) {}

  /// Says that `share_done` (0 … 1) of `what` is done. Throws Cancelled if stopping was asked for.
  void at(std::string_view what, double share_done) const {
    if (report_) report_(what, share_done);
    if (cancel_ != nullptr && cancel_->load()) throw Cancelled();
  }

 private:
  Report report_;
  const std::atomic<bool>* cancel_ = nullptr;
};

}  // namespace rebake
