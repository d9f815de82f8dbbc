#pragma once

#include <array>
#include <optional>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/scene/object.h"
#include "mesh_ops/select/picture.h"

namespace rebake {

/// Eye positions: these standpoints, or anywhere in a box, or, with neither, all around the object.
struct EyeRegion {
  std::vector<Standpoint> standpoints;  ///< in object space
  std::optional<Box> box;               ///< in world space
  Affine world_to_object = Affine::Identity();
};

/// Visibility of triangles, from rays between random opaque texels and random eyes.
struct Sightings {
  TriangleSet unseen;
  int rays_each = 0;       ///< rays per unseen triangle
  std::uint64_t rays = 0;  ///< total number of rays
  /// Smallest share of unoccluded rays among the visible triangles: the smallest opening found. 1 if none is visible.
  double smallest_opening = 1;
  std::size_t seen_once = 0;  ///< triangles reached by a single ray
};

/// Traces rays from each triangle until four are unoccluded. For triangles that a thousand rays do not reach, the
/// number is doubled until a doubling finds nothing new or `most_rays` are traced. Triangles without an opaque texel
/// are unseen. Only opaque texels occlude. The same at any number of threads.
Sightings look_from(const BakedObject& object, const EyeRegion& eyes, int most_rays, const Progress& progress = {});
/// Upper bound, with 95 % confidence, of the unoccluded share of lines of sight of any of `triangles` triangles that
/// `rays` rays each did not reach: (1 - share)^rays = 0.05 / triangles.
double most_missed(std::size_t triangles, int rays);

/// Number of bits per feature; 8: unchanged.
using FeatureBits = std::array<int, 8>;
struct BitsFound {
  FeatureBits bits{8, 8, 8, 8, 8, 8, 8, 8};
  double psnr_db = 0;  ///< of texels' display colours over directions; infinite if nothing is lost
};
/// Fewest bits that keep this PSNR on a sample of texels and directions, by greedily removing the bit with the least
/// loss.
BitsFound fewest_bits(const BakedObject& object, double psnr_db, const Progress& progress = {});
/// The texture with the features of its opaque texels rounded; opaque texels stay opaque. The same pointer if nothing
/// changes.
std::shared_ptr<const FeatureTexture> with_bits(const std::shared_ptr<const FeatureTexture>& texels,
                                                const FeatureBits& bits);

/// A set's texture with unused texels cleared: transparent ones, and those outside the rectangles of its triangles. The
/// same pointer if nothing changes.
std::shared_ptr<const FeatureTexture> with_empty_rest(const TextureSet& set);

}  // namespace rebake
