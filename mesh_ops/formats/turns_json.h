#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// Attaches turns to the sets of an object read from the same folder: turns.json, which turns.bin (turns_file.h) has
/// replaced. For each set, runs of faces with their corners' matrices. Throws FileError.
void read_turns_json(std::string_view text, const std::filesystem::path& name, std::vector<TextureSet>& sets);

}  // namespace rebake
