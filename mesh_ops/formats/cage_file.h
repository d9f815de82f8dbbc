#pragma once

#include <filesystem>

#include "mesh_ops/base/source_guard.h"
#include "mesh_ops/deform/cage.h"

namespace rebake {

/// Reads a closed triangle mesh (OBJ, OFF or PLY). Throws FileError, saying which kind of cage it is not.
Cage read_cage(const std::filesystem::path& path);

/// Writes one, in the format that the name ends with.
void write_cage(const Cage& cage, const std::filesystem::path& path, const SourceGuard& guard);

}  // namespace rebake
