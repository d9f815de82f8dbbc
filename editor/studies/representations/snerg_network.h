#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "editor/studies/representations/cell_adam.h"
#include "editor/studies/representations/snerg_scene.h"

namespace rebake {

/// The network of a SNeRG scene while it is fitted, with both hidden layers 16 wide, in single precision.
class SnergNetwork {
 public:
  static constexpr std::size_t inputs = SnergDecoder::inputs, width = 16, outputs = 3;

  SnergNetwork();

  /// Activations of a ray, for backward().
  struct Pass {
    std::array<float, inputs> input;
    std::array<float, width> first, second;
    std::array<float, outputs> output;
  };
  /// What the network adds to a colour. `sum`: colour and features of a ray.
  std::array<float, outputs> forward(const Eigen::Vector3f& direction, const std::array<float, 7>& sum,
                                     Pass& pass) const;
  /// Adds the gradient of the parameters to a lane, and returns that of `sum`. `slope`: gradient of the output.
  std::array<float, 7> backward(std::size_t lane, const Pass& pass, const std::array<float, outputs>& slope);
  /// A step of Adam with the mean gradient of `batch` rays.
  void step(std::size_t batch, double rate_scale);

  SnergDecoder decoder() const;

  /// See CellAdam.
  void save(std::string& bytes) const { adam_.save(bytes); }
  void load(std::string_view& bytes);

 private:
  // One cell whose channels are all parameters: weights [output][input] and biases of each layer.
  CellAdam adam_;
  std::vector<float> by_input_;  ///< the same weights as [input][output]

  void order_by_input();
};

}  // namespace rebake
