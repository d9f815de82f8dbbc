#pragma once

#include <array>
#include <vector>

#include "mesh_ops/reconstruction/ray_batch.h"

namespace rebake {

// Pixels of several rays, whose features are averaged before they are decoded, as in rendering.

/// Opacities of a batch's hits, with the weights per ray.
struct WeightedHits {
  std::vector<double> opacities;
  std::vector<RayWeights> weights;
};

/// The hits of a batch that matter for its colours, with their features.
struct ShownHits {
  std::vector<std::uint32_t> hits;  ///< indices in the batch
  std::vector<std::int32_t> index;  ///< per hit of the batch: its number in this list; −1: none
  std::vector<FieldPoint> points;
  std::vector<float> features;  ///< [shown hit][8]
};

/// Mean features (weights times features, not divided by the opacity) and opacity of a pixel, and the derivatives of
/// the loss by them.
struct PixelMean {
  std::array<double, texel_features> features{}, feature_slopes{};
  double opacity = 0, opacity_slope = 0;
  Vec3 fed = Vec3::Zero();  ///< mean direction
};

/// The mean over the rays `pixel` · each … of a batch.
PixelMean mean_of(const RayBatch& batch, std::size_t pixel, std::size_t each, const WeightedHits& kind,
                  const ShownHits& shown);
/// Adds the derivatives of the loss by the features and (if not null) the opacities of a pixel's hits, for those by its
/// mean. `feature_slopes` as ShownHits::features, `alpha_slopes` per hit of the batch.
void add_hit_slopes(const RayBatch& batch, std::size_t pixel, std::size_t each, const WeightedHits& kind,
                    const ShownHits& shown, const PixelMean& mean, std::vector<float>& feature_slopes,
                    std::vector<float>* alpha_slopes);

}  // namespace rebake
