#pragma once

#include <functional>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// Triangles whose centre, after `transform`, is inside.
TriangleSet triangles_by_centre(const BakedObject& object, const Affine& transform,
                                const std::function<bool(const Vec3&)>& inside);

/// Triangles joined through shared corner positions (equal bit for bit, since files repeat them) to the one whose
/// centre is nearest to `point`, in object space. Transparent corners join too.
TriangleSet triangles_connected(const BakedObject& object, const Vec3& point);

}  // namespace rebake
