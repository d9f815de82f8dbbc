#include "editor/studies/representations/cell_adam.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "mesh_ops/reconstruction/gradient_steps.h"

namespace rebake {

double fit_rate(double passes) {
  const double doublings = std::log2(std::max(passes, 1.0));
  // Share of the doubling that is done; all of the first pass counts as one.
  const double done = passes < 1 ? passes : passes / std::exp2(std::floor(doublings)) - 1;
  return std::pow(10, -std::max(0.0, 2 * done - 1)) / std::sqrt(1 + passes);
}

CellAdam::CellAdam(std::size_t cells, std::vector<float> rates)
    : channels_(rates.size()),
      rates_(std::move(rates)),
      values_(cells * channels_),
      mean_(cells * channels_),
      square_(cells * channels_) {
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    gradients_[lane].resize(cells * channels_);
    touched_[lane].resize(cells);
  }
}

void CellAdam::step(std::size_t batch, double rate_scale, const std::function<void(float*)>& bound) {
  constexpr float first = 0.9F, second = 0.99F, least = 1e-8F;
  ++steps_;
  const float mean_scale = 1 / (1 - std::pow(first, static_cast<float>(steps_))),
              square_scale = 1 / (1 - std::pow(second, static_cast<float>(steps_))),
              share = 1 / static_cast<float>(batch), rate_factor = static_cast<float>(rate_scale);
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, touched_[0].size(), 4096), [&](const tbb::blocked_range<std::size_t>& range) {
        for (std::size_t cell = range.begin(); cell < range.end(); ++cell) {
          bool any = false;
          for (auto& lane : touched_) any = any || lane[cell] != 0;
          if (!any) continue;
          for (std::size_t c = 0; c < channels_; ++c) {
            const std::size_t k = cell * channels_ + c;
            float gradient = 0;
            for (std::size_t lane = 0; lane < lanes; ++lane) {
              gradient += gradients_[lane][k];
              gradients_[lane][k] = 0;
            }
            gradient *= share;
            mean_[k] += (1 - first) * (gradient - mean_[k]);
            square_[k] += (1 - second) * (gradient * gradient - square_[k]);
            values_[k] -=
                rate_factor * rates_[c] * mean_[k] * mean_scale / (std::sqrt(square_[k] * square_scale) + least);
          }
          for (auto& lane : touched_) lane[cell] = 0;
          bound(&values_[cell * channels_]);
        }
      });
}

void CellAdam::save(std::string& bytes) const {
  put_numbers(bytes, values_);
  put_numbers(bytes, mean_);
  put_numbers(bytes, square_);
  put_numbers(bytes, std::vector<int>{steps_});
}

void CellAdam::load(std::string_view& bytes) {
  take_numbers(bytes, values_);
  take_numbers(bytes, mean_);
  take_numbers(bytes, square_);
  std::vector<int> steps{0};
  take_numbers(bytes, steps);
  steps_ = steps.front();
}

}  // namespace rebake
