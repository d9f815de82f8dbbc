#include <torch/torch.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <string>
#include <vector>

#include "mesh_ops/light/learned/unet_layers.h"
#include "mesh_ops/light/learned/unet_training.h"

namespace {

using torch::Tensor;

// The network of unet_layers(); all convolutions but the last are followed by batch normalisation.
struct Network : torch::nn::Module {
  explicit Network(int channels) {
    for (const rebake::UnetLayer& layer : rebake::unet_layers(channels)) {
      const auto options = torch::nn::Conv2dOptions(layer.inputs, layer.outputs, layer.kernel)
                               .stride(layer.stride)
                               .padding(layer.kernel / 2);
      const std::string name = std::to_string(convolutions.size());
      convolutions.push_back(register_module("convolution" + name, torch::nn::Conv2d(options)));
      // The output layer is not normalised.
      if (layer.kernel > 1) norms.push_back(register_module("norm" + name, torch::nn::BatchNorm2d(layer.outputs)));
    }
  }

  Tensor apply(const Tensor& x) {
    const std::size_t k = next++;
    const Tensor y = convolutions[k]->forward(x);
    return k < norms.size() ? norms[k]->forward(y) : y;
  }
  Tensor residual(const Tensor& x) {
    const Tensor inner = torch::relu(apply(x));
    return torch::relu(apply(inner) + x);
  }
  Tensor forward(Tensor x) {
    next = 0;
    x = torch::relu(apply(x));
    std::vector<Tensor> skipped;
    for (int l = 0; l < rebake::unet_levels; ++l) {
      skipped.push_back(residual(x));
      x = torch::relu(apply(skipped.back()));
    }
    x = residual(x);
    for (int l = rebake::unet_levels - 1; l >= 0; --l) {
      const Tensor wide = x.repeat_interleave(2, 2).repeat_interleave(2, 3);
      x = residual(torch::relu(apply(wide) + skipped[static_cast<std::size_t>(l)]));
    }
    return apply(x);
  }

  // Weights and biases in the order that Unet expects, with batch normalisation folded in.
  std::vector<float> folded() {
    std::vector<float> result;
    for (std::size_t k = 0; k < convolutions.size(); ++k) {
      Tensor weight = convolutions[k]->weight, bias = convolutions[k]->bias;
      if (k < norms.size()) {
        const auto& norm = norms[k];
        const Tensor scale = norm->weight / torch::sqrt(norm->running_var + norm->options.eps());
        weight = weight * scale.view({-1, 1, 1, 1});
        bias = (bias - norm->running_mean) * scale + norm->bias;
      }
      for (const Tensor& part : {weight.contiguous(), bias.contiguous()})
        result.insert(result.end(), part.data_ptr<float>(), part.data_ptr<float>() + part.numel());
    }
    return result;
  }

  std::vector<torch::nn::Conv2d> convolutions;
  std::vector<torch::nn::BatchNorm2d> norms;
  std::size_t next = 0;
};

int train(const rebake::UnetTask& task, float* result) {
  torch::manual_seed(task.seed);
  // More threads are no faster on images this small, and slow each other down on a busy machine.
  torch::set_num_threads(1);
  const auto poses = static_cast<std::int64_t>(task.poses);
  const auto tensor = [](const float* values, const std::vector<std::int64_t>& shape) {
    return torch::from_blob(const_cast<float*>(values), shape, torch::kFloat32);
  };
  const Tensor images = tensor(task.images, {poses, rebake::unet_inputs, task.side, task.side}),
               targets = tensor(task.targets, {poses, rebake::unet_outputs, task.side, task.side});
  Network network(task.channels);
  torch::optim::Adam adam(network.parameters(), torch::optim::AdamOptions(task.rate));
  const std::int64_t batches = (poses + task.batch - 1) / task.batch;
  network.train();
  for (int epoch = 0; epoch < task.epochs; ++epoch) {
    const Tensor order = torch::randperm(poses);
    double sum = 0;
    for (std::int64_t b = 0; b < batches; ++b) {
      // Cosine decay of the learning rate to a hundredth (Loshchilov and Hutter 2017).
      const double done =
          (static_cast<double>(epoch) + static_cast<double>(b) / static_cast<double>(batches)) / task.epochs;
      static_cast<torch::optim::AdamOptions&>(adam.param_groups()[0].options())
          .lr(task.rate * (0.01 + 0.99 * 0.5 * (1 + std::cos(std::numbers::pi * done))));
      const Tensor some = order.slice(0, b * task.batch, std::min(poses, (b + 1) * task.batch));
      adam.zero_grad();
      const Tensor loss = (network.forward(images.index_select(0, some)) - targets.index_select(0, some)).abs().mean();
      loss.backward();
      adam.step();
      sum += loss.item<double>();
      if (!task.progress(task.user, done, sum / static_cast<double>(b + 1))) return 1;
    }
  }
  network.eval();
  const torch::NoGradGuard guard;
  const std::vector<float> folded = network.folded();
  std::memcpy(result, folded.data(), folded.size() * sizeof(float));
  return 0;
}

}  // namespace

extern "C" [[gnu::visibility("default")]] int rebake_train_unet(const rebake::UnetTask* task, float* result,
                                                                char* error, std::size_t error_size) {
  try {
    return train(*task, result);
  } catch (const std::exception& failure) {
    std::strncpy(error, failure.what(), error_size - 1);
    error[error_size - 1] = 0;
    return 2;
  }
}
