#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "mesh_ops/training/feature_network.h"

namespace rebake {

/// Decodes the colours of texels along view directions, in batches of 16.
class TexelColors {
 public:
  using Features = std::array<double, 8>;

  /// `directions`: unit vectors, as fed to the decoder. `decoder` must outlive this object.
  TexelColors(const Decoder& decoder, std::vector<Vec3> directions);

  std::size_t directions() const { return directions_.size(); }
  /// Display colours, as [texel][direction]: `colors` has features.size() × directions() elements. Single precision
  /// (errors below 1e-5), or double for hidden layers wider than 256. Thread-safe.
  void decode_into(std::span<const Features> features, std::span<Color> colors) const;
  /// As decode_into(), but with one direction per texel.
  void decode_each(std::span<const Features> features, std::span<const Vec3> directions, std::span<Color> colors) const;

 private:
  const Decoder& decoder_;
  FeatureNetwork network_;
  std::vector<Vec3> directions_;
};

/// Unit vectors spread evenly over the sphere (Fibonacci lattice).
std::vector<Vec3> even_directions(std::size_t count);

}  // namespace rebake
