#pragma once

#include <functional>
#include <memory>
#include <string>

#include "mesh_ops/deform/cage_deformation.h"
#include "mesh_ops/scene/object.h"

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

/// The object with its flagged triangles deformed in world space. Each place is deformed once, so that corners that
/// coincide move alike bit for bit; what the deformation leaves where it was keeps its bits. Within `falloff` (world
/// units) of the edges and corners that unflagged triangles share, the deformation fades out, smoothly and without
/// cracks; with 0 it ends at the border, where shared corners are split. Turns get the local rotations' change.
struct DeformedObject {
  std::shared_ptr<const BakedObject> object;  ///< `folded` says which triangles have a corner at a folded place
  DeformationReport report;
};
DeformedObject deformed(const BakedObject& object, const Affine& to_world, const TriangleSet& flags, double falloff,
                        const SpaceDeformation& deformation);

}  // namespace rebake
