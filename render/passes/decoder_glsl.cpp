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

using Arithmetic = RenderOptions::Arithmetic;

// Statements that compute c0, c1 and c2, the outputs before the logistic function: one per neuron.
std::string scalar_layers(const Decoder& decoder, RenderOptions::Precision precision, Arithmetic arithmetic) {
  static const char* const inputs[] = {"low.x",  "low.y",  "low.z", "low.w", "high.x", "high.y",
                                       "high.z", "high.w", "ray.x", "ray.y", "ray.z"};
  const bool halves = arithmetic == Arithmetic::halves;
  const std::string type = halves ? "float16_t" : "float", suffix = halves ? "hf" : "";
  std::string out;
  if (halves)
    for (std::size_t k = 0; k < std::size(inputs); ++k)
      out += fmt::format("  float16_t x{} = float16_t({});\n", k, inputs[k]);
  for_each_neuron(decoder, [&](int layer, Eigen::Index j, double bias, const Eigen::VectorXd& weights) {
    out += fmt::format("  {} {}{} = ", type, "abc"[layer], j);
    std::string sum = fmt::format("{:.9e}{}", rounded(bias, precision), suffix);
    for (Eigen::Index i = 0; i < weights.size(); ++i) {
      const float w = rounded(weights[i], precision);
      if (w == 0 && arithmetic != Arithmetic::all_scalars) continue;
      sum += layer == 0 && !halves ? fmt::format(" + {:.9e} * {}", w, inputs[i])
                                   : fmt::format(" + {:.9e}{} * {}{}", w, suffix, "xab"[layer], i);
    }
    out += layer == 2 ? sum + ";\n" : halves ? fmt::format("ramp({});\n", sum) : fmt::format("max({}, 0.0);\n", sum);
  });
  return out;
}

// A layer as products of 4×4 matrices and vectors: `in`0, `in`1, … to `to`0, `to`1, …
std::string vector_layer(const Eigen::MatrixXd& weights, const Eigen::VectorXd& bias, const char* in, const char* to,
                         RenderOptions::Precision precision) {
  const Eigen::Index inputs = weights.rows(), outputs = weights.cols();
  const auto value = [&](Eigen::Index i, Eigen::Index o) {
    return i < inputs && o < outputs ? rounded(weights(i, o), precision) : 0.0F;
  };
  std::string out;
  for (Eigen::Index o = 0; o < outputs; o += 4) {
    std::string sum = "vec4(";
    for (Eigen::Index k = 0; k < 4; ++k)
      sum += fmt::format("{}{:.9e}", k > 0 ? ", " : "", o + k < outputs ? rounded(bias[o + k], precision) : 0.0F);
    sum += ")";
    for (Eigen::Index i = 0; i < inputs; i += 4) {
      std::string matrix;
      bool any = false;
      // Columns of the matrix belong to inputs.
      for (Eigen::Index column = 0; column < 4; ++column)
        for (Eigen::Index row = 0; row < 4; ++row) {
          const float w = value(i + column, o + row);
          any = any || w != 0;
          matrix += fmt::format("{}{:.9e}", matrix.empty() ? "" : ", ", w);
        }
      if (any) sum += fmt::format(" + mat4({}) * {}{}", matrix, in, i / 4);
    }
    out += fmt::format("  vec4 {}{} = {};\n", to, o / 4, sum);
  }
  return out;
}

// As scalar_layers(), by vectors.
std::string vector_layers(const Decoder& d, RenderOptions::Precision precision) {
  const auto ramps = [](const char* of, Eigen::Index outputs) {
    std::string out;
    for (Eigen::Index k = 0; 4 * k < outputs; ++k) out += fmt::format("  {0}{1} = max({0}{1}, 0.0);\n", of, k);
    return out;
  };
  return "  vec4 x0 = low, x1 = high, x2 = vec4(ray, 0.0);\n" + vector_layer(d.weights0, d.bias0, "x", "a", precision) +
         ramps("a", d.bias0.size()) + vector_layer(d.weights1, d.bias1, "a", "b", precision) +
         ramps("b", d.bias1.size()) + vector_layer(d.weights2, d.bias2, "b", "sum", precision) +
         "  float c0 = sum0.x, c1 = sum0.y, c2 = sum0.z;\n";
}

}  // namespace

std::string decoder_constants_glsl(const std::vector<std::shared_ptr<const Decoder>>& decoders,
                                   RenderOptions::Precision precision, RenderOptions::Arithmetic arithmetic) {
  std::string out;
  if (arithmetic == Arithmetic::halves)
    out = fmt::format("#extension {} : require\nfloat16_t ramp(float16_t x) {{ return x > 0.0hf ? x : 0.0hf; }}\n",
                      half_extension);
  for (std::size_t k = 0; k < decoders.size(); ++k) {
    const ColorRule rule = decoders[k]->rule;
    out += fmt::format("vec3 decode_{}(vec4 low, vec4 high, vec3 ray) {{\n", k);
    if (rule == ColorRule::diffuse) {
      out += "  return low.yzw / low.x;\n}\n";
      continue;
    }
    if (rule == ColorRule::diffuse_and_network)
      out += "  float share = low.x;\n  low /= share;\n  high /= share;\n  ray /= share;\n";
    out += arithmetic == Arithmetic::vectors ? vector_layers(*decoders[k], precision)
                                             : scalar_layers(*decoders[k], precision, arithmetic);
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
