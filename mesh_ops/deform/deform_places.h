#pragma once

#include <functional>
#include <limits>
#include <vector>

#include "mesh_ops/deform/cage_deformation.h"
#include "mesh_ops/index/weld.h"

namespace rebake {

/// What a deformation did to an object.
struct DeformationReport {
  std::size_t points = 0;          ///< places that corners of deformed triangles lie at
  std::size_t folded = 0;          ///< of them, those where det J ≤ 0: turned inside out or collapsed
  std::size_t undefined = 0;       ///< those with no local rotation of their own, which got a neighbour's
  std::size_t outside = 0;         ///< those that the coordinates do not reach; they stay
  std::size_t opaque_outside = 0;  ///< of them, corners of triangles that show something
  std::size_t not_finite = 0;      ///< those whose position is no number, or would be none; they stay
  double least_determinant = 1;    ///< of J, over all points that have one
};

/// A deformation of space: where points go, and its Jacobian there.
using SpaceDeformation = std::function<DeformedPoints(const std::vector<Vec3>& world)>;

/// The places that corners of flagged triangles lie at.
struct FlaggedPlaces {
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  std::vector<std::uint32_t> number_of;  ///< of every welded place its number among these, or none
  std::vector<std::uint8_t> shared;      ///< a flag a welded place: unflagged triangles have it too
  std::vector<Vec3> world;               ///< in world space
};
FlaggedPlaces flagged_places(const BakedObject& object, const WeldedCorners& corners, const Affine& to_world,
                             const TriangleSet& flags);

/// What became of them, one each.
struct DeformedPlaces {
  std::vector<Vec3> world;
  std::vector<Mat3> rotations;       ///< in the object's space: what colours turn by
  std::vector<double> determinants;  ///< of the Jacobians; 1 where there is none
  DeformationReport report;
};

/// Places deformed in world space, once each, so that corners that coincide move alike bit for bit; what the
/// deformation leaves where it was keeps its bits. It fades out within `falloff` of the border (see fade_out).
DeformedPlaces deform_places(const BakedObject& object, const WeldedCorners& corners, const Affine& to_world,
                             const TriangleSet& flags, const FlaggedPlaces& places, double falloff,
                             const SpaceDeformation& deformation);

}  // namespace rebake
