#pragma once

#include <array>
#include <optional>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/scene/object.h"
#include "mesh_ops/select/picture.h"

namespace rebake {

/// Possible eye positions: these standpoints, else anywhere in the box, else all around the object.
struct EyeRegion {
  std::vector<Viewpoint> viewpoints;  ///< in object space
  std::optional<Box> box;             ///< in world space
  Affine world_to_object = Affine::Identity();
};

/// Visibility of triangles, from rays between random opaque texels and random eyes.
struct VisibilityReport {
  TriangleSet unseen;      ///< triangles that no ray reached
  TriangleSet seen_once;   ///< triangles that a single ray reached
  TriangleSet opaque;      ///< triangles with an opaque texel
  int rays_each = 0;       ///< rays per unseen triangle
  std::uint64_t rays = 0;  ///< total number of rays
  /// Smallest share of unoccluded rays among the visible triangles: the narrowest opening that was found. 1 if no
  /// triangle is visible.
  double smallest_opening = 1;
};

/// Traces rays between random eyes and each triangle until four are unoccluded. For triangles that 1024 rays do not
/// reach, the number of rays is doubled until a doubling finds nothing new or `max_rays` are traced. Triangles without
/// an opaque texel are unseen. Only opaque texels occlude. The same result at any number of threads.
VisibilityReport traced_visibility(const BakedObject& object, const EyeRegion& eyes, int max_rays,
                                   const Progress& progress = {});
/// Upper bound, with 95 % confidence, of the unoccluded share of lines of sight of any of `triangles` triangles that
/// `rays` rays each did not reach: (1 - share)^rays = 0.05 / triangles.
double missed_share_bound(std::size_t triangles, int rays);

/// Number of bits per feature, 1 … 8; 8: unchanged.
using FeatureBits = std::array<int, 8>;
/// Result of fewest_bits().
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
std::shared_ptr<const FeatureTexture> without_unused_texels(const TextureSet& set);

}  // namespace rebake
