#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "mesh_ops/rays/scene_rays.h"
#include "mesh_ops/scene/scene.h"

namespace rebake {

/// A texture of display colours without view dependence.
struct MeanColors {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  ///< row by row; alpha 255 where the texel is opaque, else 0
};

/// Loss of an object's view dependence.
struct MeanColorLoss {
  double squares = 0;      ///< weighted sum of squared differences of display colours, per channel
  double weight = 0;       ///< sum of the weights of texels and directions
  std::size_t hidden = 0;  ///< triangles with opaque texels that no direction sees
  /// PSNR in dB between the colours along the directions from which texels are visible and their means; 100 for none.
  double psnr_db() const;
};

/// Mean display colours of the texels of a node's set, over those of `directions` even directions from which the centre
/// of their triangle is visible in `rays`; over all where none is. A direction counts by the area that the triangle has
/// in pictures from there (the cosine to its normal). Texels beside a triangle, which lookups at its edge may fetch,
/// get the colour of a neighbour. Adds to `loss`. With `eye`, a point in world space, colours are instead those along
/// the direction from there to the triangle's centre, visible or not; `loss` then compares them with the colours along
/// the directions.
MeanColors mean_colors(const TextureSet& set, const PlacedNode& placed, const SceneRays& rays, double scene_size,
                       std::size_t directions, MeanColorLoss& loss, const std::optional<Vec3>& eye = std::nullopt);

}  // namespace rebake
