#pragma once

#include <array>
#include <memory>
#include <optional>

#include "mesh_ops/texture/decoder.h"
#include "mesh_ops/texture/texels.h"

// Bounds, not estimates: by interval arithmetic through the network, rounded outward.

namespace rebake {

/// What the view direction does to a decoder's colours.
struct DirectionUse {
  double change = 0;  ///< no display colour changes by more between any direction and none (0, 0, 0)
  /// The decoder with all weights of the direction 0.
  std::shared_ptr<const Decoder> without;
};
DirectionUse direction_use(const Decoder& decoder);

/// Smallest and largest value of each feature.
struct FeatureRange {
  bool any = false;  ///< there is something opaque
  std::array<double, 8> low{}, high{};
};
/// Of a texture's opaque texels; nothing where one of them varies by more than 16 of its 255 steps, which is found out
/// in the first tile of most textures.
std::optional<FeatureRange> narrow_feature_range(const FeatureTexture& texture);

/// A display colour's channels.
struct ColorRange {
  Color low, high;
  void join(const ColorRange& other);
  double widest() const { return (high - low).maxCoeff(); }
};
/// Of all features in a range, seen from any direction, where `share` of a pixel's samples show them and the others
/// show nothing: features and direction are averaged over all samples, so the decoder sees `share` of them.
ColorRange color_range(const Decoder& decoder, const FeatureRange& features, double share);

}  // namespace rebake
