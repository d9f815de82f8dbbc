#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace rebake {

/// Rays per step: few for small sets, so that a pass has about 64 steps or more.
inline std::size_t batch_size(std::size_t rays) { return std::clamp<std::size_t>(rays / 64, 256, 8192); }

/// Factor of the learning rate after `passes` over the rays. It falls as the inverse root of the passes, and in the
/// second half of each doubling (from 1 to 2, 2 to 4, …) to a tenth of that: results are taken at the doublings, where
/// the rate is low, after which it rises again (Loshchilov and Hutter 2017, warm restarts).
double fit_rate(double passes);

/// Adam (Kingma and Ba 2015) on values per cell, of which each step changes only the cells that a batch touches. A
/// batch is divided among `lanes` parts with gradients of their own, so that results do not depend on the number of
/// threads.
class CellAdam {
 public:
  static constexpr std::size_t lanes = 4;

  /// `rates`: learning rate of each channel.
  CellAdam(std::size_t cells, std::vector<float> rates);

  float* values(std::size_t cell) { return &values_[cell * channels_]; }
  const float* values(std::size_t cell) const { return &values_[cell * channels_]; }
  /// Gradient of a cell in a lane, to be added to; marks the cell as touched.
  float* gradient(std::size_t lane, std::size_t cell) {
    touched_[lane][cell] = 1;
    return &gradients_[lane][cell * channels_];
  }
  /// A step with the mean gradient of `batch` rays; clears gradients. `bound` limits the values of a cell afterwards.
  void step(std::size_t batch, double rate_scale, const std::function<void(float* values)>& bound);

  /// The state between two steps: appended to `bytes`, and taken from their front. Throws Error if they end too early.
  void save(std::string& bytes) const;
  void load(std::string_view& bytes);

 private:
  std::size_t channels_;
  std::vector<float> rates_, values_, mean_, square_;
  std::array<std::vector<float>, lanes> gradients_;
  std::array<std::vector<std::uint8_t>, lanes> touched_;
  int steps_ = 0;
};

}  // namespace rebake
