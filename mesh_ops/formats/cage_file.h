#pragma once

#include <filesystem>

#include "mesh_ops/deform/cages/cage_mesh.h"

namespace rebake {

/// Reads a manifold triangle mesh (OBJ, OFF or PLY, at most 1 GiB), which may be open. Materials and colours are
/// ignored. Coordinates of PLY files are rounded to floats by OpenMesh. Throws FileError.
Cage read_triangles(const std::filesystem::path& path);
/// As read_triangles(), checked with checked_cage(). Throws FileError, naming the requirement of a cage that the mesh
/// violates.
Cage read_cage(const std::filesystem::path& path);

}  // namespace rebake
