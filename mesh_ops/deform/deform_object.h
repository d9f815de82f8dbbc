#pragma once

#include <memory>

#include "mesh_ops/deform/deform_places.h"
#include "mesh_ops/scene/object.h"

namespace rebake {

/// Triangles with a corner where the last deformation of their object folded or collapsed: the face attribute "folded"
/// (std::uint8_t), which deformed() sets.
TriangleSet folded_triangles(const BakedObject& object);

/// The object with its flagged triangles deformed in world space (see deform_places). Where a falloff is 0, corners
/// shared with unflagged triangles are split.
struct DeformedObject {
  std::shared_ptr<const BakedObject> object;
  DeformationReport report;
};
DeformedObject deformed(const BakedObject& object, const Affine& to_world, const TriangleSet& flags, double falloff,
                        const SpaceDeformation& deformation);

}  // namespace rebake
