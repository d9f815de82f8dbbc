#include "editor/studies/representations/snerg_network.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace rebake {

namespace {

constexpr std::size_t inputs = SnergNetwork::inputs, width = SnergNetwork::width, outputs = SnergNetwork::outputs;
// Places of the layers among the parameters.
constexpr std::size_t weights0 = 0, bias0 = weights0 + width * inputs, weights1 = bias0 + width,
                      bias1 = weights1 + width * width, weights2 = bias1 + width, bias2 = weights2 + outputs * width,
                      parameters = bias2 + outputs;

// Sums are in local arrays, which nothing else refers to, so that compilers vectorise the inner loops.

// `by_input`: weights [input][output].
template <std::size_t In, std::size_t Out>
void layer(const float* by_input, const float* bias, const std::array<float, In>& in, std::array<float, Out>& out) {
  std::array<float, Out> sums;
  std::copy_n(bias, Out, sums.begin());
  for (std::size_t i = 0; i < In; ++i) {
    const float value = in[i];
    for (std::size_t o = 0; o < Out; ++o) sums[o] += by_input[i * Out + o] * value;
  }
  out = sums;
}

// Adds gradients of weights [output][input] and bias; `slope_in`: gradient of the layer's input.
template <std::size_t In, std::size_t Out>
void layer_back(const float* weights, const std::array<float, In>& in, const std::array<float, Out>& slope,
                float* weights_slope, float* bias_slope, std::array<float, In>& slope_in) {
  const std::array<float, In> values = in;
  std::array<float, In> sums{};
  for (std::size_t o = 0; o < Out; ++o) {
    const float one = slope[o];
    if (one == 0) continue;  // rectified
    bias_slope[o] += one;
    float* row_slope = weights_slope + o * In;
    for (std::size_t i = 0; i < In; ++i) row_slope[i] += one * values[i];
    const float* row = weights + o * In;
    for (std::size_t i = 0; i < In; ++i) sums[i] += one * row[i];
  }
  slope_in = sums;
}

template <std::size_t N>
void rectify(std::array<float, N>& values) {
  for (float& value : values) value = std::max(value, 0.0F);
}

template <std::size_t N>
void mask(const std::array<float, N>& activation, std::array<float, N>& slope) {
  for (std::size_t k = 0; k < N; ++k)
    if (activation[k] <= 0) slope[k] = 0;
}

}  // namespace

SnergNetwork::SnergNetwork() : adam_(1, std::vector<float>(parameters, 0.005F)) {
  std::mt19937 random(2);
  const auto fill = [&](std::size_t begin, std::size_t end, std::size_t in) {
    const double reach = std::sqrt(6.0 / static_cast<double>(in));  // He et al. 2015
    for (std::size_t k = begin; k < end; ++k)
      adam_.values(0)[k] = static_cast<float>(reach * (random() / 2147483647.5 - 1));
  };
  fill(weights0, bias0, inputs);
  fill(weights1, bias1, width);
  fill(weights2, bias2, width);
  for (std::size_t k = bias2; k < parameters; ++k) adam_.values(0)[k] = -3;  // adds little at first
  order_by_input();
}

void SnergNetwork::order_by_input() {
  const auto order = [&](std::size_t weights, std::size_t in, std::size_t out) {
    for (std::size_t o = 0; o < out; ++o)
      for (std::size_t i = 0; i < in; ++i) by_input_[weights + i * out + o] = adam_.values(0)[weights + o * in + i];
  };
  by_input_.resize(parameters);
  order(weights0, inputs, width);
  order(weights1, width, width);
  order(weights2, width, outputs);
}

std::array<float, outputs> SnergNetwork::forward(const Eigen::Vector3f& direction, const std::array<float, 7>& sum,
                                                 Pass& pass) const {
  const auto encoded = encoded_direction(direction.cast<double>());
  for (std::size_t k = 0; k < encoded.size(); ++k) pass.input[k] = static_cast<float>(encoded[k]);
  std::copy(sum.begin(), sum.end(), pass.input.begin() + SnergDecoder::encoding);
  const float *p = adam_.values(0), *weights = by_input_.data();
  layer(weights + weights0, p + bias0, pass.input, pass.first);
  rectify(pass.first);
  layer(weights + weights1, p + bias1, pass.first, pass.second);
  rectify(pass.second);
  layer(weights + weights2, p + bias2, pass.second, pass.output);
  for (float& value : pass.output) value = 1 / (1 + std::exp(-value));
  return pass.output;
}

std::array<float, 7> SnergNetwork::backward(std::size_t lane, const Pass& pass,
                                            const std::array<float, outputs>& slope) {
  const float* p = adam_.values(0);
  float* g = adam_.gradient(lane, 0);
  std::array<float, outputs> last = slope;
  for (std::size_t k = 0; k < outputs; ++k) last[k] *= pass.output[k] * (1 - pass.output[k]);
  std::array<float, width> second{}, first{};
  std::array<float, inputs> in{};
  layer_back(p + weights2, pass.second, last, g + weights2, g + bias2, second);
  mask(pass.second, second);
  layer_back(p + weights1, pass.first, second, g + weights1, g + bias1, first);
  mask(pass.first, first);
  layer_back(p + weights0, pass.input, first, g + weights0, g + bias0, in);
  std::array<float, 7> result{};
  std::copy_n(in.begin() + SnergDecoder::encoding, result.size(), result.begin());
  return result;
}

void SnergNetwork::step(std::size_t batch, double rate_scale) {
  adam_.step(batch, rate_scale, [](float*) {});
  order_by_input();
}

void SnergNetwork::load(std::string_view& bytes) {
  adam_.load(bytes);
  order_by_input();
}

SnergDecoder SnergNetwork::decoder() const {
  const float* p = adam_.values(0);
  const auto matrix = [&](std::size_t at, std::size_t in, std::size_t out) {
    Eigen::MatrixXd result(static_cast<Eigen::Index>(in), static_cast<Eigen::Index>(out));
    for (std::size_t o = 0; o < out; ++o)
      for (std::size_t i = 0; i < in; ++i)
        result(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(o)) = static_cast<double>(p[at + o * in + i]);
    return result;
  };
  const auto vector = [&](std::size_t at, std::size_t size) {
    Eigen::VectorXd result(static_cast<Eigen::Index>(size));
    for (std::size_t k = 0; k < size; ++k) result[static_cast<Eigen::Index>(k)] = static_cast<double>(p[at + k]);
    return result;
  };
  return {matrix(weights0, inputs, width),
          matrix(weights1, width, width),
          matrix(weights2, width, outputs),
          vector(bias0, width),
          vector(bias1, width),
          vector(bias2, outputs)};
}

}  // namespace rebake
