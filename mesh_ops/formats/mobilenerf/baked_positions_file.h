#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// The first bytes of baked.bin.
inline constexpr std::string_view positions_mark = "rebakebp";

/// Encodes baked.bin, a sidecar file (sidecar_file.h) beside a folder's own files: the vertex displacements since light
/// was baked (Soup::displacement), and the body that each face belongs to (BakedObject::body). Mark "rebakebp",
/// version 1. Per texture set with such values: displacements (3 f32 per vertex) as corner_values(), then runs of faces
/// of the same body. A run is two put_varint() numbers: face count and body number.
std::string write_baked_positions(const std::vector<TextureSet>& sets);

/// Whether any set has displacements or body numbers.
bool any_baked_positions(const std::vector<TextureSet>& sets);

/// Decodes baked.bin into attributes of the sets of an object, which must have been read from the same folder and has
/// `bodies` bodies. Throws FileError.
void read_baked_positions(std::string_view bytes, const std::filesystem::path& name, std::size_t bodies,
                          std::vector<TextureSet>& sets);

}  // namespace rebake
