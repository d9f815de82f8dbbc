#include "mesh_ops/reconstruction/compositing.h"

namespace rebake {

void set_weights(std::span<const double> opacities, RayWeights& result) {
  result.weights.clear();
  result.before.clear();
  result.through = 1;
  for (const double opacity : opacities) {
    result.before.push_back(result.through);
    result.weights.push_back(opacity * result.through);
    result.through *= 1 - opacity;
  }
}

void opacity_slopes(std::span<const double> opacities, const RayWeights& at, std::span<const double> weight_slopes,
                    double through_slope, std::span<double> slopes) {
  // What the loss gains per light that passes hit k.
  double behind = through_slope;
  for (std::size_t k = opacities.size(); k-- > 0;) {
    slopes[k] = at.before[k] * (weight_slopes[k] - behind);
    behind = opacities[k] * weight_slopes[k] + (1 - opacities[k]) * behind;
  }
}

Vec3 ray_color(const RayWeights& weights, std::span<const Vec3> colors, const Vec3& background) {
  Vec3 color = weights.through * background;
  for (std::size_t k = 0; k < colors.size(); ++k) color += weights.weights[k] * colors[k];
  return color;
}

void ray_color_slopes(std::span<const double> opacities, const RayWeights& weights, std::span<const Vec3> colors,
                      const Vec3& background, const Vec3& slope, std::span<Vec3> by_color,
                      std::span<double> by_opacity) {
  std::vector<double> by_weight(colors.size());
  for (std::size_t k = 0; k < colors.size(); ++k) {
    by_weight[k] = slope.dot(colors[k]);
    by_color[k] = weights.weights[k] * slope;
  }
  opacity_slopes(opacities, weights, by_weight, slope.dot(background), by_opacity);
}

double distortion(std::span<const double> weights, std::span<const double> places, double scale,
                  std::span<double> slopes) {
  const std::size_t count = weights.size();
  double all = 0, moment = 0;
  for (std::size_t k = 0; k < count; ++k) {
    all += weights[k];
    moment += weights[k] * places[k];
  }
  // Weights, and weights times places, of the hits before.
  double loss = 0, sum = 0, places_sum = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const double x = places[k], nearer = x * sum - places_sum,
                 farther = (moment - places_sum - weights[k] * x) - x * (all - sum - weights[k]);
    loss += weights[k] * (nearer + farther);
    slopes[k] += scale * 2 * (nearer + farther);
    sum += weights[k];
    places_sum += weights[k] * x;
  }
  for (std::size_t k = 0; k + 1 < count; ++k) {
    const double step = places[k + 1] - places[k];
    loss += (weights[k] * weights[k] + weights[k + 1] * weights[k + 1]) * step / 6;
    slopes[k] += scale * weights[k] * step / 3;
    slopes[k + 1] += scale * weights[k + 1] * step / 3;
  }
  return loss;
}

}  // namespace rebake
