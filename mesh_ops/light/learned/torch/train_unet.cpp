#include <torch/torch.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "mesh_ops/light/learned/unet_layers.h"
#include "mesh_ops/light/learned/unet_training.h"

namespace {

using rebake::UnetForm;
using torch::Tensor;

// The network of unet_layers(); all convolutions but the last are followed by batch normalisation.
struct Network : torch::nn::Module {
  Network(UnetForm kind, int channels) : form(kind) {
    for (const rebake::UnetLayer& layer : rebake::unet_layers(form, channels)) {
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
    const int levels = rebake::unet_levels(form);
    for (int l = 0; l < levels; ++l) {
      skipped.push_back(residual(x));
      x = torch::relu(apply(skipped.back()));
    }
    x = residual(x);
    for (int l = levels - 1; l >= 0; --l) {
      const Tensor wide = x.repeat_interleave(2, 2).repeat_interleave(2, 3);
      const Tensor& skip = skipped[static_cast<std::size_t>(l)];
      x = residual(
          torch::relu(form == UnetForm::concatenated ? apply(torch::cat({wide, skip}, 1)) : apply(wide) + skip));
    }
    x = apply(x);
    return form == UnetForm::concatenated ? torch::sigmoid(x) : x;
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
      for (const Tensor& part : {weight.contiguous().cpu(), bias.contiguous().cpu()})
        result.insert(result.end(), part.data_ptr<float>(), part.data_ptr<float>() + part.numel());
    }
    return result;
  }

  UnetForm form;
  std::vector<torch::nn::Conv2d> convolutions;
  std::vector<torch::nn::BatchNorm2d> norms;
  std::size_t next = 0;
};

// A training between two epochs.
struct Training {
  explicit Training(const rebake::UnetTask& its_task)
      : task(its_task),
        device(task.cuda ? torch::kCUDA : torch::kCPU),
        network(task.form, task.channels),
        adam((network.to(device), network.parameters()), torch::optim::AdamOptions(task.rate)) {
    const auto tensor = [&](const float* values, std::int64_t planes) {
      return torch::from_blob(const_cast<float*>(values),
                              {static_cast<std::int64_t>(task.poses + task.held_out), planes, task.side, task.side},
                              torch::kFloat32)
          .to(device);
    };
    images = tensor(task.images, rebake::unet_inputs);
    targets = tensor(task.targets, rebake::unet_outputs);
  }

  // Everything that the next epoch depends on, apart from the data.
  void save() {
    if (*task.checkpoint == 0) return;
    torch::serialize::OutputArchive all, of_network, of_adam;
    network.save(of_network);
    adam.save(of_adam);
    all.write("network", of_network);
    all.write("adam", of_adam);
    all.write("epoch", torch::tensor(epoch));
    all.write("identity", torch::tensor(static_cast<std::int64_t>(task.identity)));
    const std::string next = std::string(task.checkpoint) + ".next";
    all.save_to(next);
    std::filesystem::rename(next, task.checkpoint);
  }
  void load() {
    if (*task.checkpoint == 0 || !std::filesystem::exists(task.checkpoint)) return;
    torch::serialize::InputArchive all, of_network, of_adam;
    all.load_from(task.checkpoint, device);
    all.read("network", of_network);
    all.read("adam", of_adam);
    Tensor number;
    all.read("identity", number);
    if (number.item<std::int64_t>() != static_cast<std::int64_t>(task.identity))
      throw std::runtime_error("the checkpoint is of a training with other data or options; remove it: " +
                               std::string(task.checkpoint));
    network.load(of_network);
    adam.load(of_adam);
    all.read("epoch", number);
    epoch = number.item<int>();
  }

  // One pass over the poses, in an order that depends on seed and epoch only. Returns the mean loss; negative if
  // cancelled, and then part of the epoch is done.
  double run_epoch() {
    network.train();
    const auto poses = static_cast<std::int64_t>(task.poses);
    const std::int64_t batches = (poses + task.batch - 1) / task.batch;
    torch::manual_seed(task.seed + static_cast<std::uint64_t>(epoch));
    const Tensor order = torch::randperm(poses).to(device);
    double sum = 0;
    Tensor sums = torch::zeros({}, device);
    for (std::int64_t b = 0; b < batches; ++b) {
      // Cosine decay of the learning rate (Loshchilov and Hutter 2017).
      const double done =
          (static_cast<double>(epoch) + static_cast<double>(b) / static_cast<double>(batches)) / task.epochs;
      static_cast<torch::optim::AdamOptions&>(adam.param_groups()[0].options())
          .lr(task.last_rate + (task.rate - task.last_rate) * 0.5 * (1 + std::cos(std::numbers::pi * done)));
      const Tensor some = order.slice(0, b * task.batch, std::min(poses, (b + 1) * task.batch));
      adam.zero_grad();
      const Tensor loss = (network.forward(images.index_select(0, some)) - targets.index_select(0, some)).abs().mean();
      loss.backward();
      adam.step();
      sums += loss.detach();
      // Reading the loss waits for the graphics card.
      constexpr std::int64_t between_reads = 8;
      if (!task.cuda || b % between_reads == 0 || b + 1 == batches)
        sum = sums.item<double>() / static_cast<double>(b + 1);
      if (!task.progress(task.user, done, sum)) return -1;
    }
    return sum;
  }

  // Mean loss of the held-out poses; NaN without such.
  double held_out_loss() {
    if (task.held_out == 0) return std::numeric_limits<double>::quiet_NaN();
    network.eval();
    const torch::NoGradGuard guard;
    double sum = 0;
    for (std::size_t k = 0; k < task.held_out; ++k) {
      const auto at = static_cast<std::int64_t>(task.poses + k);
      sum += (network.forward(images.slice(0, at, at + 1)) - targets.slice(0, at, at + 1)).abs().mean().item<double>();
    }
    return sum / static_cast<double>(task.held_out);
  }

  const rebake::UnetTask& task;
  torch::Device device;
  Network network;
  torch::optim::Adam adam;
  Tensor images, targets;
  int epoch = 0;
};

int train(const rebake::UnetTask& task, float* result) {
  if (task.cuda && !torch::cuda::is_available())
    throw std::runtime_error("LibTorch finds no graphics card with CUDA; train on the processor");
  torch::manual_seed(task.seed);
  torch::set_num_threads(task.threads);
  Training training(task);
  training.load();
  auto saved = std::chrono::steady_clock::now();
  while (training.epoch < task.epochs) {
    const double loss = training.run_epoch();
    if (loss < 0) return 1;
    ++training.epoch;
    task.epoch(task.user, training.epoch, loss, training.held_out_loss());
    const auto now = std::chrono::steady_clock::now();
    if (training.epoch == task.epochs || std::chrono::duration<double>(now - saved).count() > task.checkpoint_seconds) {
      training.save();
      saved = now;
    }
  }
  training.network.eval();
  const torch::NoGradGuard guard;
  const std::vector<float> folded = training.network.folded();
  if (folded.size() != rebake::unet_weight_count(task.form, task.channels))
    throw std::runtime_error("the checkpoint holds a network of another size; remove it");
  std::memcpy(result, folded.data(), folded.size() * sizeof(float));
  return 0;
}

}  // namespace

extern "C" [[gnu::visibility("default")]] int rebake_train_unet_2(const rebake::UnetTask* task, float* result,
                                                                  char* error, std::size_t error_size) {
  try {
    return train(*task, result);
  } catch (const std::exception& failure) {
    std::strncpy(error, failure.what(), error_size - 1);
    error[error_size - 1] = 0;
    return 2;
  }
}
