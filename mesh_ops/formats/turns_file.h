#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// How triangles were turned apart from their object: turns.bin, kept beside a folder's own files, which have no place
/// for it. Numbers are little-endian:
///
///     "rebaketn", u32 version 1, u64 XXH64 of all that follows, u32 number of texture sets with turns, and of each, by
///     number: u32 number of the set, u32 of its faces, u32 of different turns, u32 bytes of the faces' part; the
///     turns, 20 bytes each (Turn::bytes), in the order in which corners first have them; the faces' part, numbers of 7
///     bits a byte, the lowest first (LEB128): 2n: n faces that are not turned, 2n + 1: n that are, and of each corner
///     of these 0 for the next of the turns, or how many before it.
///
/// Faces are numbered as the folder's files list them: writing chunks renumbers vertices, but never faces.
std::string write_turns(const std::vector<TextureSet>& sets);

/// Attaches turns to the sets of an object read from the same folder. Throws FileError.
void read_turns(std::string_view bytes, const std::filesystem::path& name, std::vector<TextureSet>& sets);

}  // namespace rebake
