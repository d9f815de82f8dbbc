#include "mesh_ops/reconstruction/compositing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

using namespace rebake;

namespace {

using LongValues = std::vector<long double>;

// Derivative of a function of several numbers, by central differences.
long double difference(const std::function<long double(const LongValues&)>& f, LongValues at, std::size_t k) {
  const long double step = 1e-6L, here = at[k];
  at[k] = here + step;
  const long double above = f(at);
  at[k] = here - step;
  return (above - f(at)) / (2 * step);
}

// Opacities of rays: random ones, all transparent, all opaque, and opaque ones between others.
std::vector<std::vector<double>> opacities_of_rays() {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<std::vector<double>> result{{}, {0}, {1}, {0, 0, 0, 0}, {1, 1, 1}, {0.2, 1, 0.7}, {1e-5, 1 - 1e-5, 1e-5}};
  for (int n = 1; n < 40; ++n) {
    result.emplace_back();
    for (int k = 0; k < n; ++k) result.back().push_back(std::pow(unit(random), 4));
  }
  return result;
}

long double weighted_loss(const LongValues& opacities, const std::vector<double>& by_weight, double by_through) {
  long double through = 1, loss = 0;
  for (std::size_t k = 0; k < opacities.size(); ++k) {
    loss += by_weight[k] * opacities[k] * through;
    through *= 1 - opacities[k];
  }
  return loss + by_through * through;
}

}  // namespace

TEST(Compositing, SharesOfLightAddUpToOne) {
  for (const std::vector<double>& opacities : opacities_of_rays()) {
    RayWeights weights;
    set_weights(opacities, weights);
    double sum = weights.through;
    for (const double weight : weights.weights) sum += weight;
    EXPECT_NEAR(sum, 1, 1e-14);
  }
}

TEST(Compositing, OpacitySlopesMatchDifferences) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (const std::vector<double>& opacities : opacities_of_rays()) {
    RayWeights weights;
    set_weights(opacities, weights);
    std::vector<double> by_weight(opacities.size()), slopes(opacities.size());
    for (double& slope : by_weight) slope = normal(random);
    const double by_through = normal(random);
    opacity_slopes(opacities, weights, by_weight, by_through, slopes);
    for (std::size_t k = 0; k < opacities.size(); ++k)
      EXPECT_NEAR(
          slopes[k],
          static_cast<double>(difference([&](const LongValues& at) { return weighted_loss(at, by_weight, by_through); },
                                         {opacities.begin(), opacities.end()}, k)),
          1e-9);
  }
}

TEST(Compositing, ColorSlopesMatchDifferences) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  const Vec3 background(1, 0.5, 0.25), wanted(0.3, 0.4, 0.5);
  const auto squared_error = [&](const std::vector<double>& opacities, const std::vector<Vec3>& colors) {
    RayWeights weights;
    set_weights(opacities, weights);
    return (ray_color(weights, colors, background) - wanted).squaredNorm();
  };
  for (const std::vector<double>& opacities : opacities_of_rays()) {
    std::vector<Vec3> colors(opacities.size()), by_color(opacities.size());
    for (Vec3& color : colors) color = Vec3(normal(random), normal(random), normal(random));
    RayWeights weights;
    set_weights(opacities, weights);
    std::vector<double> by_opacity(opacities.size());
    ray_color_slopes(opacities, weights, colors, background, 2 * (ray_color(weights, colors, background) - wanted),
                     by_color, by_opacity);
    constexpr double step = 1e-5;
    for (std::size_t k = 0; k < opacities.size(); ++k) {
      const auto moved = [&](double by) {
        std::vector<double> at = opacities;
        at[k] += by;
        return squared_error(at, colors);
      };
      EXPECT_NEAR(by_opacity[k], (moved(step) - moved(-step)) / (2 * step), 1e-6);
      for (int c = 0; c < 3; ++c) {
        const auto tinted = [&](double by) {
          std::vector<Vec3> at = colors;
          at[k][c] += by;
          return squared_error(opacities, at);
        };
        EXPECT_NEAR(by_color[k][c], (tinted(step) - tinted(-step)) / (2 * step), 1e-6);
      }
    }
  }
}

TEST(Compositing, DistortionAndItsSlopesMatchTheDefinition) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(0, 1);
  for (std::size_t n = 1; n < 30; ++n) {
    std::vector<double> weights(n), places(n), slopes(n);
    double place = 0;
    for (std::size_t k = 0; k < n; ++k) {
      weights[k] = unit(random);
      places[k] = place;
      if (k % 3 != 0) place += unit(random);  // some hits are at the same place
    }
    const auto definition = [&](const LongValues& at) {
      long double loss = 0;
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j)
          loss += at[i] * at[j] * std::abs(static_cast<long double>(places[i]) - places[j]);
      for (std::size_t i = 0; i + 1 < n; ++i)
        loss += (at[i] * at[i] + at[i + 1] * at[i + 1]) * (places[i + 1] - places[i]) / 6;
      return loss;
    };
    const LongValues at(weights.begin(), weights.end());
    EXPECT_NEAR(distortion(weights, places, 0.5, slopes), static_cast<double>(definition(at)), 1e-12 * n * n);
    for (std::size_t k = 0; k < n; ++k)
      EXPECT_NEAR(slopes[k], 0.5 * static_cast<double>(difference(definition, at, k)), 1e-8 * n);
  }
}
