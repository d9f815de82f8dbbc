#pragma once

#include <atomic>
#include <functional>
#include <string_view>

#include "mesh_ops/base/error.h"

namespace rebake {

/// Reports the progress of a long task and cancels it on request. A default-constructed Progress does neither.
class Progress {
 public:
  using Report = std::function<void(std::string_view what, double share_done)>;

  Progress() = default;
  explicit Progress(Report report, const std::atomic<bool>* cancel = nullptr)
      : report_(std::move(report)), cancel_(cancel) {}

  /// Reports that the share `share_done` (0 … 1) of task `what` is done. Throws Cancelled if cancelled.
  void at(std::string_view what, double share_done) const {
    if (report_) report_(what, share_done);
    if (cancel_ != nullptr && cancel_->load()) throw Cancelled();
  }

 private:
  Report report_;
  const std::atomic<bool>* cancel_ = nullptr;
};

}  // namespace rebake
