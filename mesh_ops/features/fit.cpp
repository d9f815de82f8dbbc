#include "mesh_ops/features/fit.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <stdexcept>

#include "mesh_ops/base/elementary.h"

// Adam: Kingma & Ba 2015. The network is evaluated for `lanes` observations at once in structure-of-arrays form, which
// the compiler vectorises.

namespace rebake {

namespace {

constexpr std::size_t lanes = 16;
constexpr std::size_t widest = 64;
constexpr std::size_t block_texels = 64;  // gradients are summed a block at a time, in a fixed order
constexpr std::size_t batch_texels = 1024;
constexpr std::size_t seen_a_pass = 8;  // observations of a texel in one pass
constexpr float beta1 = 0.9F, beta2 = 0.99F, tiny = 1e-8F;

using Lane = std::array<float, lanes>;

// Weights, neuron by neuron: bias, then inputs.
struct Network {
  std::size_t hidden;
  std::vector<float> values;

  explicit Network(std::size_t width) : hidden(width), values(width * 12 + width * (width + 1) + 3 * (width + 1)) {}
  std::size_t second() const { return hidden * 12; }
  std::size_t third() const { return second() + hidden * (hidden + 1); }
};

struct Adam {
  std::vector<float> mean, square;
  explicit Adam(std::size_t count) : mean(count), square(count) {}
  void step(std::size_t i, float& value, float gradient, float rate, float correction1, float correction2) {
    mean[i] = beta1 * mean[i] + (1 - beta1) * gradient;
    square[i] = beta2 * square[i] + (1 - beta2) * gradient * gradient;
    value -= rate * (mean[i] / correction1) / (std::sqrt(square[i] / correction2) + tiny);
  }
};

// Forward and backward for one group of lanes: adds to the weights' gradient, writes the inputs' gradient, returns the
// squared error.
float evaluate(const Network& net, const std::array<Lane, 11>& input, const std::array<Lane, 3>& target,
               float* gradient, std::array<Lane, 11>* input_gradient) {
  const std::size_t h = net.hidden;
  std::array<Lane, widest> first, second, d_first, d_second;
  std::array<Lane, 3> d_out;
  const float* w = net.values.data();
  for (std::size_t j = 0; j < h; ++j, w += 12) {
    Lane sum;
    sum.fill(w[0]);
    for (std::size_t i = 0; i < 11; ++i)
      for (std::size_t l = 0; l < lanes; ++l) sum[l] += w[i + 1] * input[i][l];
    for (std::size_t l = 0; l < lanes; ++l) first[j][l] = std::max(sum[l], 0.0F);
  }
  for (std::size_t j = 0; j < h; ++j, w += h + 1) {
    Lane sum;
    sum.fill(w[0]);
    for (std::size_t i = 0; i < h; ++i)
      for (std::size_t l = 0; l < lanes; ++l) sum[l] += w[i + 1] * first[i][l];
    for (std::size_t l = 0; l < lanes; ++l) second[j][l] = std::max(sum[l], 0.0F);
  }
  float error = 0;
  for (std::size_t c = 0; c < 3; ++c, w += h + 1) {
    Lane sum;
    sum.fill(w[0]);
    for (std::size_t i = 0; i < h; ++i)
      for (std::size_t l = 0; l < lanes; ++l) sum[l] += w[i + 1] * second[i][l];
    for (std::size_t l = 0; l < lanes; ++l) {
      const float out = 1 / (1 + std::exp(-sum[l])), off = out - target[c][l];
      error += off * off;
      d_out[c][l] = 2 * off * out * (1 - out);
    }
  }
  if (gradient == nullptr) return error;

  for (std::size_t j = 0; j < h; ++j) d_second[j].fill(0);
  const auto total = [](const Lane& a, const Lane& b) {
    float sum = 0;
    for (std::size_t l = 0; l < lanes; ++l) sum += a[l] * b[l];
    return sum;
  };
  Lane one;
  one.fill(1);
  w = net.values.data() + net.third();
  float* g = gradient + net.third();
  for (std::size_t c = 0; c < 3; ++c, w += h + 1, g += h + 1) {
    g[0] += total(d_out[c], one);
    for (std::size_t i = 0; i < h; ++i) {
      g[i + 1] += total(d_out[c], second[i]);
      for (std::size_t l = 0; l < lanes; ++l) d_second[i][l] += w[i + 1] * d_out[c][l];
    }
  }
  for (std::size_t j = 0; j < h; ++j) d_first[j].fill(0);
  w = net.values.data() + net.second();
  g = gradient + net.second();
  for (std::size_t j = 0; j < h; ++j, w += h + 1, g += h + 1) {
    for (std::size_t l = 0; l < lanes; ++l) d_second[j][l] = second[j][l] > 0 ? d_second[j][l] : 0;
    g[0] += total(d_second[j], one);
    for (std::size_t i = 0; i < h; ++i) {
      g[i + 1] += total(d_second[j], first[i]);
      for (std::size_t l = 0; l < lanes; ++l) d_first[i][l] += w[i + 1] * d_second[j][l];
    }
  }
  if (input_gradient != nullptr)
    for (Lane& lane : *input_gradient) lane.fill(0);
  w = net.values.data();
  g = gradient;
  for (std::size_t j = 0; j < h; ++j, w += 12, g += 12) {
    for (std::size_t l = 0; l < lanes; ++l) d_first[j][l] = first[j][l] > 0 ? d_first[j][l] : 0;
    g[0] += total(d_first[j], one);
    for (std::size_t i = 0; i < 11; ++i) {
      g[i + 1] += total(d_first[j], input[i]);
      if (input_gradient == nullptr) continue;
      for (std::size_t l = 0; l < lanes; ++l) (*input_gradient)[i][l] += w[i + 1] * d_first[j][l];
    }
  }
  return error;
}

float decoded(const std::array<std::uint8_t, 8>& bytes, std::size_t c) {
  return c % 4 == 3 ? static_cast<float>(2 * bytes[c] - 255) / 255 : static_cast<float>(bytes[c]) / 255;
}

std::array<std::uint8_t, 8> quantised(const float* value) {
  std::array<std::uint8_t, 8> bytes{};
  for (std::size_t c = 0; c < 8; ++c) {
    // Alpha is stored as 128 … 255 and decodes to odd 255ths.
    bytes[c] = static_cast<std::uint8_t>(c % 4 == 3 ? 128 + std::clamp(std::lround((value[c] * 255 - 1) / 2), 0L, 127L)
                                                    : std::clamp(std::lround(value[c] * 255), 0L, 255L));
  }
  bytes[0] = std::max<std::uint8_t>(bytes[0], 1);
  return bytes;
}

Decoder to_decoder(const Network& net) {
  const auto h = static_cast<Eigen::Index>(net.hidden);
  Decoder d;
  const float* w = net.values.data();
  const auto layer = [&w](Eigen::MatrixXd& weights, Eigen::VectorXd& bias, Eigen::Index inputs, Eigen::Index outputs) {
    weights.resize(inputs, outputs);
    bias.resize(outputs);
    for (Eigen::Index j = 0; j < outputs; ++j) {
      bias[j] = *w++;
      for (Eigen::Index i = 0; i < inputs; ++i) weights(i, j) = *w++;
    }
  };
  layer(d.weights0, d.bias0, 11, h);
  layer(d.weights1, d.bias1, h, h);
  layer(d.weights2, d.bias2, h, 3);
  return d;
}

class Fitter {
 public:
  Fitter(const FitProblem& problem, const FitOptions& options)
      : problem_(problem),
        options_(options),
        net_(static_cast<std::size_t>(options.hidden)),
        net_adam_(net_.values.size()),
        logits_(problem.texel_count * 8),
        texel_adam_(problem.texel_count * 8) {
    if (options.hidden < 1 || static_cast<std::size_t>(options.hidden) > widest)
      throw std::invalid_argument("hidden width must be 1 to 64");
    const std::size_t count = problem.texel_count * problem.observations_a_texel;
    if (count == 0 || problem.fed_directions.size() != count || problem.colors.size() != count)
      throw std::invalid_argument("a fit needs a direction and a colour for each observation");
    if (!problem.hints.empty() && problem.hints.size() != problem.texel_count)
      throw std::invalid_argument("a fit needs a hint for each texel, or none");
    std::mt19937 random(options.seed);
    std::normal_distribution<float> normal;
    const std::size_t h = net_.hidden;
    for (std::size_t i = 0; i < net_.values.size(); ++i) {
      const std::size_t fan_in = i < net_.second() ? 11 : h;
      const std::size_t place = i < net_.second() ? i % 12 : (i - net_.second()) % (h + 1);
      net_.values[i] = place == 0 ? 0 : normal(random) * std::sqrt(2.0F / static_cast<float>(fan_in));
    }
    // Texels start at their mean colour, so that like texels have like features.
    for (std::size_t t = 0; t < problem.texel_count; ++t) {
      for (std::size_t c = 0; c < 8; ++c) {
        float mean = 0.5F;
        if (c < 3) {
          mean = 0;
          for (std::size_t k = 0; k < problem.observations_a_texel; ++k)
            mean += problem.colors[t * problem.observations_a_texel + k][c];
          mean = std::clamp(mean / static_cast<float>(problem.observations_a_texel), 0.05F, 0.95F);
        } else if (!problem.hints.empty()) {
          mean = std::clamp(problem.hints[t][c - 3], 0.05F, 0.95F);
        }
        logits_[t * 8 + c] = std::log(mean / (1 - mean));
      }
    }
    order_.resize(problem.texel_count);
    std::iota(order_.begin(), order_.end(), std::size_t{0});
  }

  FitResult run(const Progress& progress) {
    FitResult result;
    const int adjust = std::max(1, options_.epochs / 10);
    for (int epoch = 0; epoch < options_.epochs; ++epoch) {
      progress.at("fitting", static_cast<double>(epoch) / (options_.epochs + adjust));
      result.mean_squared_error.push_back(pass(epoch, rate_at(static_cast<double>(epoch) / options_.epochs), true));
    }
    for (std::size_t t = 0; t < problem_.texel_count; ++t) {
      std::array<float, 8> value{};
      for (std::size_t c = 0; c < 8; ++c) value[c] = 1 / (1 + std::exp(-logits_[t * 8 + c]));
      fixed_.push_back(quantised(value.data()));
    }
    for (int epoch = 0; epoch < adjust; ++epoch) {
      progress.at("fitting", static_cast<double>(options_.epochs + epoch) / (options_.epochs + adjust));
      pass(options_.epochs + epoch, rate_at(0.9), false);
    }
    result.decoder = to_decoder(net_);
    result.features = fixed_;
    result.quantised_mean_squared_error = whole_error();
    progress.at("fitting", 1);
    return result;
  }

 private:
  float rate_at(double share) const {
    return static_cast<float>(options_.learning_rate *
                              (0.01 + 0.99 * 0.5 * (1 + elementary::sine_cosine(std::numbers::pi * share).cosine)));
  }

  float feature(std::size_t texel, std::size_t c) const {
    return fixed_.empty() ? 1 / (1 + std::exp(-logits_[texel * 8 + c])) : decoded(fixed_[texel], c);
  }

  // One pass over all texels, some observations each; returns the mean squared error.
  double pass(int epoch, float rate, bool move_texels) {
    std::mt19937 random(options_.seed * 9176U + static_cast<unsigned>(epoch));
    std::shuffle(order_.begin(), order_.end(), random);
    double error = 0;
    for (std::size_t begin = 0; begin < order_.size(); begin += batch_texels) {
      const std::size_t end = std::min(order_.size(), begin + batch_texels),
                        blocks = (end - begin + block_texels - 1) / block_texels;
      std::vector<std::vector<float>> gradients(blocks, std::vector<float>(net_.values.size()));
      std::vector<double> errors(blocks);
      const float texel_correction1 = 1 - std::pow(beta1, static_cast<float>(epoch + 1)),
                  texel_correction2 = 1 - std::pow(beta2, static_cast<float>(epoch + 1));
      tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t b) {
        const std::size_t first = begin + b * block_texels, last = std::min(end, first + block_texels);
        std::minstd_rand pick(static_cast<unsigned>(first * 2654435761U) + static_cast<unsigned>(epoch) * 40503U + 1);
        for (std::size_t group = first; group < last; group += lanes / seen_a_pass) {
          std::array<Lane, 11> input{}, input_gradient{};
          std::array<Lane, 3> target{};
          std::array<std::size_t, lanes> texel{};
          Lane coverage{};
          for (std::size_t l = 0; l < lanes; ++l) {
            texel[l] = order_[std::min(group + l / seen_a_pass, last - 1)];
            const std::size_t seen = texel[l] * problem_.observations_a_texel + pick() % problem_.observations_a_texel;
            // A fifth is shown as at an edge, where the rule scales features and directions by coverage.
            const auto dice = pick() % 15;
            coverage[l] = dice < 3 ? 0.25F * static_cast<float>(dice + 1) : 1.0F;
            for (std::size_t c = 0; c < 8; ++c) input[c][l] = coverage[l] * feature(texel[l], c);
            for (std::size_t c = 0; c < 3; ++c) {
              input[8 + c][l] = coverage[l] * problem_.fed_directions[seen][c];
              target[c][l] = problem_.colors[seen][c];
            }
          }
          errors[b] += static_cast<double>(
              evaluate(net_, input, target, gradients[b].data(), move_texels ? &input_gradient : nullptr));
          if (!move_texels) continue;
          for (std::size_t l = 0; l < lanes; l += seen_a_pass) {
            if (group + l / seen_a_pass >= last) break;
            for (std::size_t c = 0; c < 8; ++c) {
              const std::size_t i = texel[l] * 8 + c;
              const float value = 1 / (1 + std::exp(-logits_[i]));
              float slope = 0;
              for (std::size_t k = l; k < l + seen_a_pass; ++k)
                slope += coverage[k] * input_gradient[c][k] * value * (1 - value);
              texel_adam_.step(i, logits_[i], slope, rate * 5, texel_correction1, texel_correction2);
            }
          }
        }
      });
      ++steps_;
      const float correction1 = 1 - std::pow(beta1, static_cast<float>(steps_)),
                  correction2 = 1 - std::pow(beta2, static_cast<float>(steps_));
      for (std::size_t i = 0; i < net_.values.size(); ++i) {
        float gradient = 0;
        for (const auto& block : gradients) gradient += block[i];
        net_adam_.step(i, net_.values[i], gradient / static_cast<float>((end - begin) * seen_a_pass), rate, correction1,
                       correction2);
      }
      for (const double e : errors) error += e;
    }
    return error / static_cast<double>(order_.size() * seen_a_pass * 3);
  }

  double whole_error() const {
    std::vector<double> errors((problem_.texel_count + block_texels - 1) / block_texels);
    tbb::parallel_for(std::size_t{0}, errors.size(), [&](std::size_t b) {
      for (std::size_t t = b * block_texels; t < std::min(problem_.texel_count, (b + 1) * block_texels); ++t)
        for (std::size_t k = 0; k < problem_.observations_a_texel; k += lanes) {
          const std::size_t n = std::min(lanes, problem_.observations_a_texel - k);
          std::array<Lane, 11> input{};
          std::array<Lane, 3> target{};
          for (std::size_t l = 0; l < lanes; ++l) {
            const std::size_t seen = t * problem_.observations_a_texel + k + std::min(l, n - 1);
            for (std::size_t c = 0; c < 8; ++c) input[c][l] = feature(t, c);
            for (std::size_t c = 0; c < 3; ++c)
              input[8 + c][l] = problem_.fed_directions[seen][c], target[c][l] = problem_.colors[seen][c];
          }
          errors[b] +=
              static_cast<double>(evaluate(net_, input, target, nullptr, nullptr)) * static_cast<double>(n) / lanes;
        }
    });
    return std::accumulate(errors.begin(), errors.end(), 0.0) / static_cast<double>(problem_.colors.size() * 3);
  }

  const FitProblem& problem_;
  FitOptions options_;
  Network net_;
  Adam net_adam_;
  std::vector<float> logits_;
  Adam texel_adam_;
  std::vector<std::array<std::uint8_t, 8>> fixed_;
  std::vector<std::size_t> order_;
  long steps_ = 0;
};

}  // namespace

FitResult fit(const FitProblem& problem, const FitOptions& options, const Progress& progress) {
  return Fitter(problem, options).run(progress);
}

}  // namespace rebake
