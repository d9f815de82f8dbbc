#pragma once

#include "mesh_ops/scene/object.h"

namespace rebake {

/// Triangles whose corners (positions and UVs, in any order) and texture equal those of a triangle drawn later, which
/// shows the same.
TriangleSet duplicate_triangles(const BakedObject& object);

}  // namespace rebake
