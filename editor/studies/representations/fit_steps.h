#pragma once

#include <functional>
#include <optional>
#include <string>

#include "mesh_ops/base/progress.h"

namespace rebake {

/// How a fit can be stopped and continued with the same numbers.
struct FitCheckpoints {
  struct State {
    int passes = 0;
    std::string bytes;
  };
  std::optional<State> start;  ///< to go on from
  /// Called after each pass but the last, with the state after it, which is computed when asked for. Null: not needed.
  std::function<void(int passes, const std::function<std::string()>& state)> keep = {};
};

/// Runs passes of a fit. After 1, 2, 4, … passes, `goes_on` gets their number and the packed volume, and says whether
/// to double the number of passes. Returns the last volume.
template <class Fit, class GoesOn>
auto run_fit(Fit& fit, const GoesOn& goes_on, const Progress& progress, const FitCheckpoints& checkpoints) {
  int passes = 0;
  if (checkpoints.start) {
    fit.load(checkpoints.start->bytes);
    passes = checkpoints.start->passes;
  }
  const auto keep = [&] {
    if (checkpoints.keep) checkpoints.keep(passes, [&] { return fit.save(); });
  };
  for (;;) {
    int next = 1;
    while (next <= passes) next *= 2;
    while (passes < next) {
      fit.pass(passes, progress);
      if (++passes < next) keep();
    }
    auto volume = fit.packed(passes, progress);
    if (!goes_on(passes, volume)) return volume;
    keep();
  }
}

}  // namespace rebake
