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
  int rays_each = 0;       ///< that each of the unseen sent
  std::uint64_t rays = 0;  ///< in all
  /// Of the triangles that are seen the least share of rays that got through: the smallest opening found. 1 where none
  /// is seen.
  double smallest_opening = 1;
  std::size_t seen_once = 0;  ///< triangles that one ray in all got through to
};

/// Sends rays from each triangle until four have got through. What a thousand do not reach is sent twice as many, again
/// and again, until doubling finds nothing more or `most_rays` were sent. Without an opaque texel a triangle is unseen.
/// Triangles hide each other as their opaque texels do. The same at any number of threads.
Sightings look_from(const BakedObject& object, const EyeRegion& eyes, int most_rays, const Progress& progress = {});
/// The share of a triangle's lines of sight that at most reach any of so many triangles that `rays` rays each did not,
/// with 95 % confidence: (1 - share)^rays = 0.05 / triangles.
double most_missed(std::size_t triangles, int rays);

/// Bits that each of the 8 features is rounded to; 8: as it is.
using FeatureBits = std::array<int, 8>;
struct BitsFound {
  FeatureBits bits{8, 8, 8, 8, 8, 8, 8, 8};
  double psnr_db = 0;  ///< of texels' display colours over directions; infinite where nothing is lost
};
/// The fewest bits with which a sample of an object's texels, seen along a sample of directions, keeps this PSNR: one
/// bit after another is taken from the feature that loses least by it.
BitsFound fewest_bits(const BakedObject& object, double psnr_db, const Progress& progress = {});
/// The texture with its opaque texels' features rounded; opaque ones stay opaque. The same one where nothing changes,
/// as below.
std::shared_ptr<const FeatureTexture> with_bits(const std::shared_ptr<const FeatureTexture>& texels,
                                                const FeatureBits& bits);

/// A set's texture with all texels empty that show nothing: those that are not opaque, and those beside the rectangles
/// that hold its triangles' texels.
std::shared_ptr<const FeatureTexture> with_empty_rest(const TextureSet& set);

}  // namespace rebake
