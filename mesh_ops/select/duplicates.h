#pragma once

#include "mesh_ops/scene/object.h"

namespace rebake {

/// Triangles with the same corners (places and UVs, in any order) and texels as one that is drawn later: that one shows
/// everything that they do.
TriangleSet duplicate_triangles(const BakedObject& object);

}  // namespace rebake
