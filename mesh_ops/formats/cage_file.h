#pragma once

#include <filesystem>

#include "mesh_ops/base/source_guard.h"
#include "mesh_ops/deform/cages/cage.h"

namespace rebake {

/// Reads a closed triangle mesh (OBJ, OFF or PLY, at most 1 GiB) and checks it with checked_cage(). Throws FileError,
/// naming the requirement of a cage that the mesh violates.
Cage read_cage(const std::filesystem::path& path);

/// Writes a cage in the format of the file extension (.obj, .off, .ply). Throws FileError.
void write_cage(const Cage& cage, const std::filesystem::path& path, const SourceGuard& guard);

}  // namespace rebake
