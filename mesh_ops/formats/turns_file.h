#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// How triangles were turned apart from their object: turns.bin, kept beside a folder's own files, which have no place
/// for it. A side file (side_file.h) "rebaketn" of version 1: of each texture set the turns (Turn::bytes) as corners
/// have them.
std::string write_turns(const std::vector<TextureSet>& sets);

/// Attaches turns to the sets of an object read from the same folder. Throws FileError.
void read_turns(std::string_view bytes, const std::filesystem::path& name, std::vector<TextureSet>& sets);

}  // namespace rebake
