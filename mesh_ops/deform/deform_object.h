#pragma once

#include <memory>

#include "mesh_ops/deform/deform_positions.h"
#include "mesh_ops/scene/object.h"

namespace rebake {

/// Triangles with a corner that the last deformation of the object folded or collapsed (det J ≤ 0): the face attribute
/// "folded" (std::uint8_t), which deformed() sets.
TriangleSet folded_triangles(const BakedObject& object);

/// A deformed copy of an object.
struct DeformedObject {
  std::shared_ptr<const BakedObject> object;
  DeformationReport report;
};
/// Deforms the flagged triangles in world space; see deform_positions(). If `falloff` is 0, corners that they share
/// with unflagged triangles are split.
DeformedObject deformed(const BakedObject& object, const Affine& to_world, const TriangleSet& flags, double falloff,
                        const SpaceDeformation& deformation);

}  // namespace rebake
