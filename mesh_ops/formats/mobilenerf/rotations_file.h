#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// The first bytes of turns.bin.
inline constexpr std::string_view rotations_mark = "rebaketn";

/// Encodes turns.bin, a sidecar file (sidecar_file.h) beside a folder's own files: the rotations of vertices relative
/// to their object (Soup::rotation). Mark "rebaketn", version 1. Per texture set with rotations:
/// PackedRotation::bytes() per vertex, as corner_values().
std::string write_rotations(const std::vector<TextureSet>& sets);

/// Decodes turns.bin into the sets of an object read from the same folder. Throws FileError.
void read_rotations(std::string_view bytes, const std::filesystem::path& name, std::vector<TextureSet>& sets);

}  // namespace rebake
