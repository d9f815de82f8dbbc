#pragma once

#include <filesystem>

#include "mesh_ops/deform/cages/cage_mesh.h"

namespace rebake {

/// Reads a closed triangle mesh (OBJ, OFF or PLY, at most 1 GiB) and checks it with checked_cage(). Materials
/// and colours are ignored. Coordinates of PLY files are rounded to floats by OpenMesh. Throws FileError, naming the
/// requirement of a cage that the mesh violates.
Cage read_cage(const std::filesystem::path& path);

}  // namespace rebake
