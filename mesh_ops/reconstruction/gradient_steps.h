#pragma once

#include <cstdint>

#include <string>
#include <string_view>
#include <vector>

#include "mesh_ops/base/error.h"

namespace rebake {

/// Adam (Kingma and Ba 2015) with β₁ = 0.9 and ε = 1e-15: gradients of 1e-12, as the acceleration grid has, still
/// count.
class GradientSteps {
 public:
  explicit GradientSteps(std::size_t count, double beta2 = 0.99) : beta2_(beta2), mean_(count), square_(count) {}
  /// Updates the values whose gradient is not 0; all if `dense`. Then sets the gradient to 0.
  void step(std::vector<float>& values, std::vector<float>& gradient, double rate, bool dense);
  void reset();
  void save(std::string& bytes) const;
  void load(std::string_view& bytes);

 private:
  double beta2_;
  std::vector<float> mean_, square_;
  std::uint64_t steps_ = 0;
};

/// Appends the bytes of numbers, with their count.
template <class Number>
void put_numbers(std::string& bytes, const std::vector<Number>& numbers) {
  const std::uint64_t count = numbers.size();
  bytes.append(reinterpret_cast<const char*>(&count), sizeof count);
  bytes.append(reinterpret_cast<const char*>(numbers.data()), count * sizeof(Number));
}
/// Removes the bytes of exactly numbers.size() numbers from the front. Throws Error if there are others.
void take_bytes(std::string_view& bytes, void* to, std::size_t count);
template <class Number>
void take_numbers(std::string_view& bytes, std::vector<Number>& numbers) {
  std::uint64_t count = 0;
  take_bytes(bytes, &count, sizeof count);
  if (count != numbers.size()) throw Error("belongs to a training with other options");
  take_bytes(bytes, numbers.data(), count * sizeof(Number));
}

}  // namespace rebake
