#pragma once

#include <array>
#include <optional>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/scene/object.h"
#include "mesh_ops/select/picture.h"

namespace rebake {

/// From where an object is looked at: from these standpoints, or from anywhere in a box, or, with neither, from all
/// around, outside of it.
struct EyeRegion {
  std::vector<Standpoint> standpoints;  ///< in the object's space
  std::optional<Box> box;               ///< in the world
  Affine world_to_object = Affine::Identity();
};

/// What was found by rays from random opaque texels of each triangle to random eyes.
struct Sightings {
  TriangleSet unseen;
  std::uint64_t rays = 0;  ///< in all
  /// Of the triangles that are seen the least share of rays that got through: the smallest opening found. 1 where none
  /// is seen.
  double smallest_opening = 1;
  std::size_t seen_once = 0;  ///< triangles that one ray in all got through to
};

/// Sends up to `rays` rays from each triangle, fewer where four have got through. A triangle that a share s of all
/// lines of sight reaches is taken for unseen with probability (1 − s)^rays. Triangles hide each other as their opaque
/// texels do; without an opaque texel a triangle is unseen. The same at any number of threads.
Sightings look_from(const BakedObject& object, const EyeRegion& eyes, int rays, const Progress& progress = {});
/// The share of lines of sight that at most reach what `rays` rays did not, with 95 % confidence (the rule of three).
double most_missed(int rays);

/// Bits that each of the 8 features is rounded to; 8: as it is.
using FeatureBits = std::array<int, 8>;
struct BitsFound {
  FeatureBits bits{8, 8, 8, 8, 8, 8, 8, 8};
  double psnr_db = 0;  ///< of texels' display colours over directions; infinite where nothing is lost
};
/// The fewest bits with which a sample of an object's texels, seen along a sample of directions, keeps this PSNR: one
/// bit after another is taken from the feature that loses least by it.
BitsFound fewest_bits(const BakedObject& object, double psnr_db, const Progress& progress = {});
/// The texture with its opaque texels' features rounded; opaque ones stay opaque.
std::shared_ptr<const FeatureTexture> with_bits(const FeatureTexture& texels, const FeatureBits& bits);

/// The texture with all texels that are not opaque empty: they show nothing, and compress better alike.
std::shared_ptr<const FeatureTexture> with_empty_rest(const FeatureTexture& texels);

}  // namespace rebake
