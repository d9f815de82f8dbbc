#include "mesh_ops/reconstruction/pixel_mean.h"

namespace rebake {

PixelMean mean_of(const RayBatch& batch, std::size_t pixel, std::size_t each, const WeightedHits& kind,
                  const ShownHits& shown) {
  PixelMean mean;
  for (std::size_t r = pixel * each; r < (pixel + 1) * each; ++r) {
    for (std::size_t h = batch.first[r]; h < batch.first[r + 1]; ++h) {
      if (shown.index[h] < 0) continue;
      const double weight = kind.weights[r].weights[h - batch.first[r]];
      const float* features = &shown.features[static_cast<std::size_t>(shown.index[h]) * texel_features];
      for (std::size_t f = 0; f < texel_features; ++f) mean.features[f] += weight * double{features[f]};
    }
    mean.opacity += 1 - kind.weights[r].through;
    for (std::size_t axis = 0; axis < 3; ++axis)
      mean.fed[static_cast<Eigen::Index>(axis)] += double{batch.rays[r].fed[axis]};
  }
  const double share = 1.0 / static_cast<double>(each);
  for (double& feature : mean.features) feature *= share;
  mean.opacity *= share;
  mean.fed *= share;
  return mean;
}

void add_hit_slopes(const RayBatch& batch, std::size_t pixel, std::size_t each, const WeightedHits& kind,
                    const ShownHits& shown, const PixelMean& mean, std::vector<float>& feature_slopes,
                    std::vector<float>* alpha_slopes) {
  const double share = 1.0 / static_cast<double>(each);
  std::vector<double> weight_slopes, slopes;
  for (std::size_t r = pixel * each; r < (pixel + 1) * each; ++r) {
    const std::size_t first = batch.first[r], hits = batch.first[r + 1] - first;
    weight_slopes.assign(hits, 0);
    slopes.assign(hits, 0);
    for (std::size_t k = 0; k < hits; ++k) {
      if (shown.index[first + k] < 0) continue;
      const std::size_t at = static_cast<std::size_t>(shown.index[first + k]) * texel_features;
      const double weight = kind.weights[r].weights[k];
      for (std::size_t f = 0; f < texel_features; ++f) {
        weight_slopes[k] += share * mean.feature_slopes[f] * double{shown.features[at + f]};
        feature_slopes[at + f] += static_cast<float>(share * weight * mean.feature_slopes[f]);
      }
    }
    if (alpha_slopes == nullptr) continue;
    opacity_slopes({kind.opacities.data() + first, hits}, kind.weights[r], weight_slopes, -share * mean.opacity_slope,
                   slopes);
    for (std::size_t k = 0; k < hits; ++k) (*alpha_slopes)[first + k] += static_cast<float>(slopes[k]);
  }
}

}  // namespace rebake
