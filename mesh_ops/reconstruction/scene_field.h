#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace rebake {

/// A point in the unit cube, in which fields are defined.
using FieldPoint = std::array<float, 3>;

/// A trained function from points of the unit cube to numbers 0 … 1: opacity (1 output) or features (8).
class SceneField {
 public:
  virtual ~SceneField() = default;
  virtual std::size_t outputs() const = 0;
  virtual std::size_t parameters() const = 0;
  /// Sets `values` to the outputs at all points, as [point][output].
  virtual void evaluate(const std::vector<FieldPoint>& points, std::vector<float>& values) const = 0;
  /// Backpropagation: adds the gradient by the parameters. `slopes`: derivatives of the loss by the outputs, as
  /// [point][output]. Sets `point_slopes` to those by the points; null: not needed.
  virtual void backpropagate(const std::vector<FieldPoint>& points, const std::vector<float>& slopes,
                             std::vector<FieldPoint>* point_slopes) = 0;
  /// A step of Adam (ε = 1e-15) with the added gradients, which become 0. `rate`: as published for networks.
  virtual void step(double rate) = 0;
  /// Forgets Adam's means.
  virtual void reset_optimiser() = 0;
  /// Appends the parameters and the optimiser's state to `bytes`.
  virtual void save(std::string& bytes) const = 0;
  /// The inverse of save(). Removes the bytes of this field from the front of `bytes`. Throws Error for those of
  /// another field.
  virtual void load(std::string_view& bytes) = 0;
};

}  // namespace rebake
