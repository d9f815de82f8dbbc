#include "render/passes/decoder_glsl.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <functional>

namespace rebake {

namespace {

float rounded(double weight, RenderOptions::Precision precision) {
  const auto single = static_cast<float>(weight);
  return precision == RenderOptions::Precision::half ? static_cast<float>(Eigen::half(single)) : single;
}

// Calls `neuron(layer, index, bias, weights)` in the order of evaluation.
void for_each_neuron(const Decoder& d,
                     const std::function<void(int, Eigen::Index, double, const Eigen::VectorXd&)>& neuron) {
  for (Eigen::Index j = 0; j < d.bias0.size(); ++j) neuron(0, j, d.bias0[j], d.weights0.col(j));
  for (Eigen::Index j = 0; j < d.bias1.size(); ++j) neuron(1, j, d.bias1[j], d.weights1.col(j));
  for (Eigen::Index j = 0; j < d.bias2.size(); ++j) neuron(2, j, d.bias2[j], d.weights2.col(j));
}

}  // namespace

std::string decoder_constants_glsl(const std::vector<std::shared_ptr<const Decoder>>& decoders,
                                   RenderOptions::Precision precision) {
  static const char* const inputs[] = {"low.x",  "low.y",  "low.z", "low.w", "high.x", "high.y",
                                       "high.z", "high.w", "ray.x", "ray.y", "ray.z"};
  std::string out;
  for (std::size_t k = 0; k < decoders.size(); ++k) {
    const ColorRule rule = decoders[k]->rule;
    out += fmt::format("vec3 decode_{}(vec4 low, vec4 high, vec3 ray) {{\n", k);
    if (rule == ColorRule::diffuse) {
      out += "  return low.yzw / low.x;\n}\n";
      continue;
    }
    if (rule == ColorRule::diffuse_and_network)
      out += "  float share = low.x;\n  low /= share;\n  high /= share;\n  ray /= share;\n";
    for_each_neuron(*decoders[k], [&](int layer, Eigen::Index j, double bias, const Eigen::VectorXd& weights) {
      out += fmt::format("  float {}{} = ", "abc"[layer], j);
      std::string sum = fmt::format("{:.9e}", rounded(bias, precision));
      for (Eigen::Index i = 0; i < weights.size(); ++i) {
        const float w = rounded(weights[i], precision);
        if (w == 0) continue;
        sum += layer == 0 ? fmt::format(" + {:.9e} * {}", w, inputs[i])
                          : fmt::format(" + {:.9e} * {}{}", w, "ab"[layer - 1], i);
      }
      out += layer < 2 ? fmt::format("max({}, 0.0);\n", sum) : sum + ";\n";
    });
    out += rule == ColorRule::network ? "  return 1.0 / (1.0 + exp(-vec3(c0, c1, c2)));\n}\n"
                                      : "  return min(low.yzw + 1.0 / (1.0 + exp(-vec3(c0, c1, c2))), 1.0);\n}\n";
  }
  out += "vec3 decode(int k, vec4 low, vec4 high, vec3 ray) {\n";
  for (std::size_t k = 1; k < decoders.size(); ++k)
    out += fmt::format("  if (k == {0}) return decode_{0}(low, high, ray);\n", k);
  return out + "  return decode_0(low, high, ray);\n}\n";
}

DecoderBuffers decoder_buffers(const std::vector<std::shared_ptr<const Decoder>>& decoders,
                               RenderOptions::Precision precision) {
  DecoderBuffers result;
  for (const auto& decoder : decoders) {
    result.layout.insert(result.layout.end(),
                         {static_cast<float>(result.weights.size()), static_cast<float>(decoder->hidden0()),
                          static_cast<float>(decoder->hidden1()), static_cast<float>(decoder->rule)});
    result.widest_layer = std::max({result.widest_layer, decoder->hidden0(), decoder->hidden1()});
    for_each_neuron(*decoder, [&](int, Eigen::Index, double bias, const Eigen::VectorXd& weights) {
      result.weights.push_back(rounded(bias, precision));
      for (const double w : weights) result.weights.push_back(rounded(w, precision));
    });
  }
  while (result.weights.size() % 4 != 0) result.weights.push_back(0);
  return result;
}

}  // namespace rebake
