#pragma once

#include <functional>
#include <limits>
#include <vector>

#include "mesh_ops/deform/cage_coordinates/cage_deformation.h"
#include "mesh_ops/index/weld.h"

namespace rebake {

/// Statistics of the deformation of an object. Counts are numbers of welded corners ("places") of deformed triangles.
struct DeformationReport {
  std::size_t points = 0;          ///< all places
  std::size_t changed = 0;         ///< places that move or rotate
  std::size_t folded = 0;          ///< places with det J ≤ 0: mirrored or collapsed
  std::size_t undefined = 0;       ///< places without a unique nearest rotation; they take a neighbour's
  std::size_t outside = 0;         ///< places where the coordinates are undefined; they do not move
  std::size_t opaque_outside = 0;  ///< places counted in `outside` that belong to triangles with opaque texels
  std::size_t not_finite = 0;      ///< places with a non-finite position or Jacobian; they do not move
  double min_determinant = 1;      ///< smallest det J over all finite places
};

/// A deformation of space, with Jacobians: maps world-space points to their deformed positions.
using SpaceDeformation = std::function<DeformedPoints(const std::vector<Vec3>& world)>;

/// Welded corners ("places") of the flagged triangles.
struct FlaggedPositions {
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  std::vector<std::uint32_t> number_of;  ///< per welded place of the object: its number among these, or none
  std::vector<std::uint8_t> shared;      ///< per welded place of the object: 1 if an unflagged triangle uses it too
  std::vector<Vec3> world;               ///< positions in world space
};
FlaggedPositions flagged_positions(const BakedObject& object, const WeldedCorners& corners, const Affine& to_world,
                                   const TriangleSet& flags);

/// Deformed places; one entry per place of FlaggedPositions.
struct DeformedPositions {
  std::vector<Vec3> world;           ///< deformed positions in world space
  std::vector<Mat3> rotations;       ///< rotation of view-dependent colours, in object space
  std::vector<double> determinants;  ///< det J; 1 for places that are not finite
  DeformationReport report;
};

/// Deforms places in world space, each once, so that coincident corners move identically, bit for bit. Unmoved places
/// keep their bits. The deformation fades out within `falloff` (world units) of the border to unflagged triangles; see
/// fade_out().
DeformedPositions deform_positions(const BakedObject& object, const WeldedCorners& corners, const Affine& to_world,
                                   const TriangleSet& flags, const FlaggedPositions& places, double falloff,
                                   const SpaceDeformation& deformation);

}  // namespace rebake
