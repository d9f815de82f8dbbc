#include "mesh_ops/reconstruction/trained_network.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace rebake {

namespace {

constexpr std::size_t batches_per_task = 32;
// Tasks of backpropagation have a gradient each, whose sum has a fixed order.
constexpr std::size_t gradient_tasks = 16;

std::size_t batches_of(std::size_t samples) { return (samples + network_lanes - 1) / network_lanes; }

// Transposes up to 16 samples of `width` numbers; missing ones are 0.
void to_lanes(const float* from, std::size_t count, std::size_t width, Lanes* to) {
  for (std::size_t i = 0; i < width; ++i)
    for (std::size_t lane = 0; lane < network_lanes; ++lane) to[i].at[lane] = lane < count ? from[lane * width + i] : 0;
}
void from_lanes(const Lanes* from, std::size_t count, std::size_t width, float* to) {
  for (std::size_t lane = 0; lane < count; ++lane)
    for (std::size_t i = 0; i < width; ++i) to[lane * width + i] = from[i].at[lane];
}

}  // namespace

TrainedNetwork::TrainedNetwork(FeatureNetwork start)
    : network_(std::move(start)), gradient_(network_.values.size()), steps_(network_.values.size()) {}

void TrainedNetwork::evaluate(const std::vector<float>& inputs, std::vector<float>& outputs) const {
  const NetworkKernels& kernels = network_kernels();
  const NetworkView view = network_.view();
  const std::size_t samples = inputs.size() / view.inputs, batches = batches_of(samples);
  outputs.resize(samples * view.outputs);
  tbb::parallel_for(std::size_t{0}, (batches + batches_per_task - 1) / batches_per_task, [&](std::size_t task) {
    std::vector<Lanes> work(kernels.workspace(view)), in(view.inputs), out(view.outputs);
    for (std::size_t b = task * batches_per_task; b < std::min(batches, (task + 1) * batches_per_task); ++b) {
      const std::size_t first = b * network_lanes, count = std::min(network_lanes, samples - first);
      to_lanes(&inputs[first * view.inputs], count, view.inputs, in.data());
      kernels.forward(view, in.data(), out.data(), work.data());
      from_lanes(out.data(), count, view.outputs, &outputs[first * view.outputs]);
    }
  });
}

void TrainedNetwork::backpropagate(const std::vector<float>& inputs, const std::vector<float>& output_slopes,
                                   std::vector<float>* input_slopes) {
  const NetworkKernels& kernels = network_kernels();
  const NetworkView view = network_.view();
  const std::size_t samples = inputs.size() / view.inputs, batches = batches_of(samples),
                    per_task = (batches + gradient_tasks - 1) / gradient_tasks;
  if (input_slopes != nullptr) input_slopes->resize(inputs.size());
  std::vector<std::vector<Lanes>> gradients(gradient_tasks);
  tbb::parallel_for(std::size_t{0}, gradient_tasks, [&](std::size_t task) {
    if (task * per_task >= batches) return;
    std::vector<Lanes>& gradient = gradients[task];
    gradient.assign(gradient_.size(), Lanes{});
    std::vector<Lanes> work(kernels.workspace(view)), in(view.inputs), out(view.outputs), out_slopes(view.outputs),
        in_slopes(view.inputs);
    for (std::size_t b = task * per_task; b < std::min(batches, (task + 1) * per_task); ++b) {
      const std::size_t first = b * network_lanes, count = std::min(network_lanes, samples - first);
      to_lanes(&inputs[first * view.inputs], count, view.inputs, in.data());
      to_lanes(&output_slopes[first * view.outputs], count, view.outputs, out_slopes.data());
      kernels.forward(view, in.data(), out.data(), work.data());
      kernels.backward(view, in.data(), out.data(), out_slopes.data(), gradient.data(),
                       input_slopes == nullptr ? nullptr : in_slopes.data(), work.data());
      if (input_slopes != nullptr)
        from_lanes(in_slopes.data(), count, view.inputs, &(*input_slopes)[first * view.inputs]);
    }
  });
  for (const std::vector<Lanes>& gradient : gradients)
    for (std::size_t i = 0; i < gradient.size(); ++i)
      for (const float part : gradient[i].at) gradient_[i] += part;
}

void TrainedNetwork::save(std::string& bytes) const {
  put_numbers(bytes, network_.values);
  steps_.save(bytes);
}

void TrainedNetwork::load(std::string_view& bytes) {
  take_numbers(bytes, network_.values);
  steps_.load(bytes);
}

}  // namespace rebake
