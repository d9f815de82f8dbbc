#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// Reads turns.json, which turns.bin (rotations_file.h) has replaced, into the sets of an object read from the same
/// folder. Per set, it has runs of faces with one rotation matrix, or one per corner. Throws FileError.
void read_rotations_json(std::string_view text, const std::filesystem::path& name, std::vector<TextureSet>& sets);

}  // namespace rebake
