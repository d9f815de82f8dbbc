#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "mesh_ops/network/feature_network.h"

namespace rebake {

/// What texels look like along directions, 16 at once.
class TexelColors {
 public:
  using Features = std::array<double, 8>;

  /// Fed directions of unit length.
  TexelColors(const Decoder& decoder, std::vector<Vec3> directions);

  std::size_t directions() const { return directions_.size(); }
  /// Display colours, texel after texel, direction after direction: `colors` holds features.size() × directions(). In
  /// single precision (errors below 1e-5), in double for decoders wider than 256. Safe on several threads.
  void decode_into(std::span<const Features> features, std::span<Color> colors) const;
  /// As decode_into, each texel along a direction of its own.
  void decode_each(std::span<const Features> features, std::span<const Vec3> directions, std::span<Color> colors) const;

 private:
  const Decoder& decoder_;
  FeatureNetwork network_;
  std::vector<Vec3> directions_;
};

/// Directions spread evenly over all (a Fibonacci spiral).
std::vector<Vec3> even_directions(std::size_t count);

}  // namespace rebake
