#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// How triangles were turned apart from their object: for each set, runs of faces with their corners' turns. Kept
/// beside a folder's own files, which have no place for it. Faces are numbered as the folder's files list them.
std::string write_turns_json(const std::vector<TextureSet>& sets);

/// Attaches turns to the sets of an object read from the same folder. Throws FileError.
void read_turns_json(std::string_view text, const std::filesystem::path& name, std::vector<TextureSet>& sets);

}  // namespace rebake
