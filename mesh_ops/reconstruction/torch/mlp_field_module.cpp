#include <torch/torch.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "mesh_ops/reconstruction/mlp_field_interface.h"

namespace {

using torch::Tensor;

constexpr std::int64_t points_at_once = 8192;  // bounds the memory of a pass
std::string& last_error() {
  static std::string text;
  return text;
}

// The published network with its gradient and Adam (β 0.9 and 0.999, ε 1e-15).
class Field {
 public:
  explicit Field(const rebake::MlpFieldSizes& sizes)
      : sizes_(sizes), device_(torch::cuda::is_available() ? torch::kCUDA : torch::kCPU) {
    torch::manual_seed(sizes.seed);
    const std::int64_t inputs = 6 * sizes.octaves;
    std::int64_t from = inputs;
    for (int layer = 0; layer <= sizes.layers; ++layer) {
      const bool last = layer == sizes.layers;
      const auto to = last ? static_cast<std::int64_t>(sizes.outputs) : std::int64_t{sizes.width};
      // Glorot and Bengio (2010): uniform.
      const double bound = std::sqrt(6.0 / static_cast<double>(from + to));
      add(torch::rand({to, from}) * (2 * bound) - bound);
      add(torch::full({to}, last ? sizes.bias : 0.0F));
      from = layer + 1 == joined ? to + inputs : to;
    }
  }

  std::size_t count() const {
    std::size_t sum = 0;
    for (const Tensor& values : values_) sum += static_cast<std::size_t>(values.numel());
    return sum;
  }

  void evaluate(const float* points, std::size_t count, float* results) const {
    const torch::NoGradGuard none;
    const auto all = static_cast<std::int64_t>(count), outputs = static_cast<std::int64_t>(sizes_.outputs);
    for (std::int64_t first = 0; first < all; first += points_at_once) {
      const Tensor out = forward(part(points, first, all)).to(torch::kCPU).contiguous();
      std::copy_n(out.data_ptr<float>(), out.numel(), results + first * outputs);
    }
  }

  void backpropagate(const float* points, std::size_t count, const float* slopes, float* point_slopes) {
    const auto all = static_cast<std::int64_t>(count), outputs = static_cast<std::int64_t>(sizes_.outputs);
    for (std::int64_t first = 0; first < all; first += points_at_once) {
      Tensor at = part(points, first, all);
      at.requires_grad_(point_slopes != nullptr);
      const Tensor by_output =
          torch::from_blob(const_cast<float*>(slopes) + first * outputs, {at.size(0), outputs}).to(device_);
      forward(at).backward(by_output);
      if (point_slopes == nullptr) continue;
      const Tensor by_point = at.grad().to(torch::kCPU).contiguous();
      std::copy_n(by_point.data_ptr<float>(), by_point.numel(), point_slopes + 3 * first);
    }
  }

  void step(double rate) {
    const torch::NoGradGuard none;
    constexpr double beta1 = 0.9, beta2 = 0.999, tiny = 1e-15;
    ++steps_;
    const double correction1 = 1 - std::pow(beta1, steps_), correction2 = 1 - std::pow(beta2, steps_);
    for (std::size_t k = 0; k < values_.size(); ++k) {
      Tensor& gradient = values_[k].mutable_grad();
      if (!gradient.defined()) continue;
      means_[k].mul_(beta1).add_(gradient, 1 - beta1);
      squares_[k].mul_(beta2).addcmul_(gradient, gradient, 1 - beta2);
      values_[k].addcdiv_(means_[k] / correction1, (squares_[k] / correction2).sqrt() + tiny, -rate);
      gradient.zero_();
    }
  }

  void reset_optimiser() {
    for (Tensor& mean : means_) mean.zero_();
    for (Tensor& square : squares_) square.zero_();
    steps_ = 0;
  }

  void save(float* numbers) const {
    for (const auto* list : {&values_, &means_, &squares_})
      for (const Tensor& tensor : *list) {
        const Tensor plain = tensor.detach().to(torch::kCPU).contiguous();
        numbers = std::copy_n(plain.data_ptr<float>(), plain.numel(), numbers);
      }
    *numbers = static_cast<float>(steps_);
  }

  void load(const float* numbers) {
    const torch::NoGradGuard none;
    for (auto* list : {&values_, &means_, &squares_})
      for (Tensor& tensor : *list) {
        tensor.copy_(torch::from_blob(const_cast<float*>(numbers), tensor.sizes()));
        numbers += tensor.numel();
      }
    steps_ = static_cast<int>(*numbers);
  }

 private:
  static constexpr int joined = 5;  // the inputs are joined again after this layer

  void add(const Tensor& start) {
    values_.push_back(start.to(device_).requires_grad_(true));
    means_.push_back(torch::zeros_like(values_.back()).detach());
    squares_.push_back(torch::zeros_like(values_.back()).detach());
  }

  Tensor part(const float* points, std::int64_t first, std::int64_t all) const {
    const std::int64_t count = std::min(points_at_once, all - first);
    return torch::from_blob(const_cast<float*>(points) + 3 * first, {count, 3}).clone().to(device_);
  }

  Tensor forward(const Tensor& points) const {
    const Tensor coordinates = (2 * points - 1) * sizes_.extent;
    std::vector<Tensor> waves;
    for (int octave = 0; octave < sizes_.octaves; ++octave) {
      const Tensor scaled = coordinates * std::pow(2.0, octave);
      waves.push_back(torch::sin(scaled));
      waves.push_back(torch::cos(scaled));
    }
    const Tensor inputs = torch::cat(waves, 1);
    Tensor x = inputs;
    for (int layer = 0; layer < sizes_.layers; ++layer) {
      const auto k = static_cast<std::size_t>(2 * layer);
      x = torch::relu(torch::addmm(values_[k + 1], x, values_[k].t()));
      if (layer + 1 == joined) x = torch::cat({x, inputs}, 1);
    }
    const auto k = static_cast<std::size_t>(2 * sizes_.layers);
    return torch::sigmoid(torch::addmm(values_[k + 1], x, values_[k].t()));
  }

  rebake::MlpFieldSizes sizes_;
  torch::Device device_;
  std::vector<Tensor> values_, means_, squares_;
  int steps_ = 0;
};

// Exceptions must not cross the module's boundary.
template <class Work>
int guarded(const Work& work) {
  try {
    work();
    return 0;
  } catch (const std::exception& error) {
    last_error() = error.what();
    return 1;
  }
}

const Field& as_field(const void* field) { return *static_cast<const Field*>(field); }
Field& as_field(void* field) { return *static_cast<Field*>(field); }

constexpr rebake::MlpFieldModule functions{
    [](const rebake::MlpFieldSizes* sizes) -> void* {
      Field* made = nullptr;
      guarded([&] { made = new Field(*sizes); });
      return made;
    },
    [](void* field) { delete static_cast<Field*>(field); },
    [](const void* field) { return as_field(field).count(); },
    [](const void* field, const float* points, std::size_t count, float* values) {
      return guarded([&] { as_field(field).evaluate(points, count, values); });
    },
    [](void* field, const float* points, std::size_t count, const float* slopes, float* point_slopes) {
      return guarded([&] { as_field(field).backpropagate(points, count, slopes, point_slopes); });
    },
    [](void* field, double rate) { return guarded([&] { as_field(field).step(rate); }); },
    [](void* field) { as_field(field).reset_optimiser(); },
    [](const void* field, float* numbers) { return guarded([&] { as_field(field).save(numbers); }); },
    [](void* field, const float* numbers) { return guarded([&] { as_field(field).load(numbers); }); },
    [] { return last_error().c_str(); }};

}  // namespace

extern "C" [[gnu::visibility("default")]] const rebake::MlpFieldModule* rebake_mlp_field() { return &functions; }
