#pragma once

#include "mesh_ops/scene/scene.h"

namespace rebake {

/// Size of all visible objects in folders on disk in MB: triangles as OBJ, texels as PNG.
double folder_megabytes(const Scene& scene);

/// Number of triangles of all visible objects.
std::size_t triangles_in(const Scene& scene);

}  // namespace rebake
