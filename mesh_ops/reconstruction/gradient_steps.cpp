#include "mesh_ops/reconstruction/gradient_steps.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <cstring>

namespace rebake {

namespace {

constexpr float beta1 = 0.9F, tiny = 1e-15F;
constexpr std::size_t piece = 16384;  // numbers per task

// 1 − beta^steps, by multiplications only: the same bits on every processor.
float correction(double beta, std::uint64_t steps) {
  double power = 1;
  for (double square = beta; steps > 0; steps /= 2, square *= square)
    if (steps % 2 != 0) power *= square;
  return static_cast<float>(1 - power);
}

}  // namespace

void GradientSteps::step(std::vector<float>& values, std::vector<float>& gradient, double rate, bool dense) {
  ++steps_;
  const float correction1 = correction(beta1, steps_), correction2 = correction(beta2_, steps_),
              beta2 = static_cast<float>(beta2_);
  const auto speed = static_cast<float>(rate);
  const std::size_t count = values.size();
  tbb::parallel_for(std::size_t{0}, (count + piece - 1) / piece, [&](std::size_t p) {
    for (std::size_t i = p * piece; i < std::min(count, (p + 1) * piece); ++i) {
      const float slope = gradient[i];
      if (slope == 0 && !dense) continue;
      mean_[i] = beta1 * mean_[i] + (1 - beta1) * slope;
      square_[i] = beta2 * square_[i] + (1 - beta2) * slope * slope;
      values[i] -= speed * (mean_[i] / correction1) / (std::sqrt(square_[i] / correction2) + tiny);
      gradient[i] = 0;
    }
  });
}

void GradientSteps::reset() {
  std::fill(mean_.begin(), mean_.end(), 0.0F);
  std::fill(square_.begin(), square_.end(), 0.0F);
  steps_ = 0;
}

void GradientSteps::save(std::string& bytes) const {
  put_numbers(bytes, mean_);
  put_numbers(bytes, square_);
  bytes.append(reinterpret_cast<const char*>(&steps_), sizeof steps_);
}

void GradientSteps::load(std::string_view& bytes) {
  take_numbers(bytes, mean_);
  take_numbers(bytes, square_);
  take_bytes(bytes, &steps_, sizeof steps_);
}

void take_bytes(std::string_view& bytes, void* to, std::size_t count) {
  if (bytes.size() < count) throw Error("ends too early");
  std::memcpy(to, bytes.data(), count);
  bytes.remove_prefix(count);
}

}  // namespace rebake
