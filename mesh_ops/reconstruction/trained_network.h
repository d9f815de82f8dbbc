#pragma once

#include "mesh_ops/reconstruction/gradient_steps.h"
#include "mesh_ops/training/feature_network.h"

namespace rebake {

/// A small network (two hidden ReLU layers, logistic outputs) with its gradient and optimiser. The same bits at any
/// number of threads.
class TrainedNetwork {
 public:
  explicit TrainedNetwork(FeatureNetwork start);

  const FeatureNetwork& network() const { return network_; }
  const std::vector<float>& gradient() const { return gradient_; }
  /// Sets `outputs` to [sample][output] for `inputs`, [sample][input].
  void evaluate(const std::vector<float>& inputs, std::vector<float>& outputs) const;
  /// Adds the gradient for derivatives of the loss by the outputs. Sets `input_slopes` to those by the inputs; null:
  /// not needed.
  void backpropagate(const std::vector<float>& inputs, const std::vector<float>& output_slopes,
                     std::vector<float>* input_slopes);
  void step(double rate) { steps_.step(network_.values, gradient_, rate, true); }
  void reset_optimiser() { steps_.reset(); }
  void save(std::string& bytes) const;
  void load(std::string_view& bytes);

 private:
  FeatureNetwork network_;
  std::vector<float> gradient_;
  GradientSteps steps_;
};

}  // namespace rebake
