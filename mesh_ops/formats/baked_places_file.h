#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// Where triangles were when their light was baked, and on which body of their object: baked.bin, kept beside a
/// folder's own files. A side file (side_file.h) "rebakebp" of version 1: of each texture set with such values the
/// displacements of vertices (3 f32) as corners have them, and runs of faces of one body: how many, and the body's
/// number, both numbers of 7 bits a byte.
std::string write_baked_places(const std::vector<TextureSet>& sets);

/// Whether there is anything to be written.
bool any_baked_places(const std::vector<TextureSet>& sets);

/// Attaches them to the sets of an object read from the same folder, which has `bodies` bodies. Throws FileError.
void read_baked_places(std::string_view bytes, const std::filesystem::path& name, std::size_t bodies,
                       std::vector<TextureSet>& sets);

}  // namespace rebake
