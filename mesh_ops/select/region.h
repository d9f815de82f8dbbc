#pragma once

#include <functional>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// Triangles whose centre, in object space, is inside. `inside` is called from several threads.
TriangleSet triangles_by_centre(const BakedObject& object, const std::function<bool(const Vec3&)>& inside);

/// Triangles joined to the given one through shared corner positions (equal bit for bit, since files repeat them).
/// Transparent corners join too.
TriangleSet triangles_connected(const BakedObject& object, std::size_t triangle);

}  // namespace rebake
