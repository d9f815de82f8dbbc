#pragma once

#include <array>
#include <memory>
#include <optional>

#include "mesh_ops/texture/decoder.h"
#include "mesh_ops/texture/texels.h"

// Guaranteed bounds of decoded colours, by interval arithmetic through the network.

namespace rebake {

/// Influence of the view direction on a decoder's colours.
struct DirectionInfluence {
  double change = 0;  ///< upper bound of the change of a display colour between any unit direction and (0, 0, 0)
  /// The decoder with zero weights for the direction.
  std::shared_ptr<const Decoder> without;
};
DirectionInfluence direction_influence(const Decoder& decoder);

/// Range of each decoded feature.
struct FeatureRange {
  bool any = false;  ///< false if no texel is opaque
  std::array<double, 8> low{}, high{};
};
/// Range over a texture's opaque texels; nullopt if a feature varies by more than 16 of its 255 levels. For most
/// textures the first tile decides.
std::optional<FeatureRange> narrow_feature_range(const FeatureTexture& texture);

/// Range of each display colour channel.
struct ColorRange {
  Color low, high;
  void join(const ColorRange& other);  ///< extends this range to include `other`
  double widest() const { return (high - low).maxCoeff(); }
};
/// Bounds for all features in a range and all view directions, with a margin for rounding in shaders. `share` of a
/// pixel's samples show the texels, and the others are empty. The decoder is fed features and direction averaged over
/// all samples, that is, scaled by `share`. Except under ColorRule::network, feature 0 must be 1.
ColorRange color_range(const Decoder& decoder, const FeatureRange& features, double share);

}  // namespace rebake
