#include "mesh_ops/training/fit.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <stdexcept>

#include "mesh_ops/training/feature_network.h"

namespace rebake {

namespace {

constexpr std::size_t lanes = network_lanes;  // observations per SIMD batch
constexpr std::size_t block_texels = 64;      // texels per partial sum of gradients, which are added in a fixed order
constexpr std::size_t batch_texels = 1024;
constexpr std::size_t observations_per_epoch = 8;  // observations per texel and epoch

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

class Fitter {
 public:
  Fitter(const FitProblem& problem, const FitOptions& options)
      : problem_(problem),
        options_(options),
        net_(decoder_inputs, hidden_of(options), hidden_of(options), 3),
        net_adam_(net_.values.size()),
        logits_(problem.texel_count * 8),
        texel_adam_(problem.texel_count * 8) {
    const std::size_t count = problem.texel_count * problem.observations_per_texel;
    if (count == 0 || problem.fed_directions.size() != count || problem.colors.size() != count)
      throw std::invalid_argument("each observation needs a direction and a colour");
    if (!problem.hints.empty() && problem.hints.size() != problem.texel_count)
      throw std::invalid_argument("there must be one hint per texel, or none");
    randomise(net_, options.seed);
    // Features 0–2 start at the texel's mean colour, so that similar texels get similar features.
    for (std::size_t t = 0; t < problem.texel_count; ++t) {
      for (std::size_t c = 0; c < 8; ++c) {
        float mean = 0.5F;
        if (c < 3) {
          mean = 0;
          for (std::size_t k = 0; k < problem.observations_per_texel; ++k)
            mean += problem.colors[t * problem.observations_per_texel + k][c];
          mean = std::clamp(mean / static_cast<float>(problem.observations_per_texel), 0.05F, 0.95F);
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
    result.decoder = net_.to_decoder();
    result.features = fixed_;
    result.quantised_mean_squared_error = whole_error();
    progress.at("fitting", 1);
    return result;
  }

 private:
  static std::size_t hidden_of(const FitOptions& options) {
    if (options.hidden < 1 || options.hidden > static_cast<int>(widest_layer))
      throw std::invalid_argument("hidden width must be 1 to 256");
    return static_cast<std::size_t>(options.hidden);
  }
  float rate_at(double share) const { return static_cast<float>(options_.learning_rate) * cosine_rate(share); }

  // Squared error of one batch of observations. Adds to the network's `gradient` and writes `input_gradient`, unless
  // they are null.
  float evaluate(const std::array<Lanes, decoder_inputs>& input, const std::array<Lanes, 3>& target, Lanes* gradient,
                 Lanes* input_gradient, Lanes* work) const {
    const NetworkKernels& kernels = network_kernels();
    std::array<Lanes, 3> output, slopes;
    kernels.forward(net_.view(), input.data(), output.data(), work);
    float error = 0;
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t l = 0; l < lanes; ++l) {
        const float off = output[c].at[l] - target[c].at[l];
        error += off * off;
        slopes[c].at[l] = 2 * off;
      }
    if (gradient != nullptr)
      kernels.backward(net_.view(), input.data(), output.data(), slopes.data(), gradient, input_gradient, work);
    return error;
  }

  float feature(std::size_t texel, std::size_t c) const {
    return fixed_.empty() ? 1 / (1 + std::exp(-logits_[texel * 8 + c])) : decoded(fixed_[texel], c);
  }

  // One epoch over all texels, with a random sample of their observations. Returns the mean squared error.
  double pass(int epoch, float rate, bool move_texels) {
    std::mt19937 random(options_.seed * 9176U + static_cast<unsigned>(epoch));
    std::shuffle(order_.begin(), order_.end(), random);
    double error = 0;
    for (std::size_t begin = 0; begin < order_.size(); begin += batch_texels) {
      const std::size_t end = std::min(order_.size(), begin + batch_texels),
                        blocks = (end - begin + block_texels - 1) / block_texels;
      std::vector<std::vector<Lanes>> gradients(blocks, std::vector<Lanes>(net_.values.size()));
      std::vector<double> errors(blocks);
      tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t b) {
        std::vector<Lanes> work(network_kernels().workspace(net_.view()));
        const std::size_t first = begin + b * block_texels, last = std::min(end, first + block_texels);
        std::minstd_rand pick(static_cast<unsigned>(first * 2654435761U) + static_cast<unsigned>(epoch) * 40503U + 1);
        for (std::size_t group = first; group < last; group += lanes / observations_per_epoch) {
          std::array<Lanes, decoder_inputs> input{}, input_gradient{};
          std::array<Lanes, 3> target{};
          std::array<std::size_t, lanes> texel{};
          Lanes coverage{};
          for (std::size_t l = 0; l < lanes; ++l) {
            texel[l] = order_[std::min(group + l / observations_per_epoch, last - 1)];
            const std::size_t seen =
                texel[l] * problem_.observations_per_texel + pick() % problem_.observations_per_texel;
            // A fifth of the observations is at an edge, where the rendering rule scales features and directions by
            // coverage.
            const auto dice = pick() % 15;
            coverage.at[l] = dice < 3 ? 0.25F * static_cast<float>(dice + 1) : 1.0F;
            for (std::size_t c = 0; c < 8; ++c) input[c].at[l] = coverage.at[l] * feature(texel[l], c);
            for (std::size_t c = 0; c < 3; ++c) {
              input[8 + c].at[l] = coverage.at[l] * problem_.fed_directions[seen][c];
              target[c].at[l] = problem_.colors[seen][c];
            }
          }
          errors[b] += static_cast<double>(
              evaluate(input, target, gradients[b].data(), move_texels ? input_gradient.data() : nullptr, work.data()));
          if (!move_texels) continue;
          for (std::size_t l = 0; l < lanes; l += observations_per_epoch) {
            if (group + l / observations_per_epoch >= last) break;
            for (std::size_t c = 0; c < 8; ++c) {
              const std::size_t i = texel[l] * 8 + c;
              const float value = 1 / (1 + std::exp(-logits_[i]));
              float slope = 0;
              for (std::size_t k = l; k < l + observations_per_epoch; ++k)
                slope += coverage.at[k] * input_gradient[c].at[k] * value * (1 - value);
              texel_adam_.step_one(i, logits_[i], slope, rate * 5, epoch + 1);
            }
          }
        }
      });
      mean_gradient_.assign(net_.values.size(), 0);
      for (std::size_t i = 0; i < net_.values.size(); ++i) {
        for (const auto& block : gradients)
          for (const float value : block[i].at) mean_gradient_[i] += value;
        mean_gradient_[i] /= static_cast<float>((end - begin) * observations_per_epoch);
      }
      net_adam_.step(net_.values, mean_gradient_, rate);
      for (const double e : errors) error += e;
    }
    return error / static_cast<double>(order_.size() * observations_per_epoch * 3);
  }

  double whole_error() const {
    std::vector<double> errors((problem_.texel_count + block_texels - 1) / block_texels);
    tbb::parallel_for(std::size_t{0}, errors.size(), [&](std::size_t b) {
      std::vector<Lanes> work(network_kernels().workspace(net_.view()));
      for (std::size_t t = b * block_texels; t < std::min(problem_.texel_count, (b + 1) * block_texels); ++t)
        for (std::size_t k = 0; k < problem_.observations_per_texel; k += lanes) {
          const std::size_t n = std::min(lanes, problem_.observations_per_texel - k);
          std::array<Lanes, decoder_inputs> input{};
          std::array<Lanes, 3> target{};
          for (std::size_t l = 0; l < lanes; ++l) {
            const std::size_t seen = t * problem_.observations_per_texel + k + std::min(l, n - 1);
            for (std::size_t c = 0; c < 8; ++c) input[c].at[l] = feature(t, c);
            for (std::size_t c = 0; c < 3; ++c)
              input[8 + c].at[l] = problem_.fed_directions[seen][c], target[c].at[l] = problem_.colors[seen][c];
          }
          errors[b] += static_cast<double>(evaluate(input, target, nullptr, nullptr, work.data())) *
                       static_cast<double>(n) / lanes;
        }
    });
    return std::accumulate(errors.begin(), errors.end(), 0.0) / static_cast<double>(problem_.colors.size() * 3);
  }

  const FitProblem& problem_;
  FitOptions options_;
  FeatureNetwork net_;
  Adam net_adam_;
  std::vector<float> logits_;
  Adam texel_adam_;
  std::vector<std::array<std::uint8_t, 8>> fixed_;
  std::vector<std::size_t> order_;
  std::vector<float> mean_gradient_;
};

}  // namespace

FitResult fit(const FitProblem& problem, const FitOptions& options, const Progress& progress) {
  return Fitter(problem, options).run(progress);
}

}  // namespace rebake
