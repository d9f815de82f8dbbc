#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "mesh_ops/base/types.h"

namespace rebake {

/// The parts of a PLY file that Rebake uses.
struct PlyFile {
  std::vector<Vec3> positions;
  std::vector<Vec2> uvs;                             ///< per vertex, v up; empty if there are none
  std::vector<std::array<double, 3>> colors;         ///< per vertex, 0 … 1; empty if there are none
  std::vector<std::vector<std::uint32_t>> polygons;  ///< vertex numbers, all in range, at least 3 each
  std::vector<std::vector<double>> polygon_uvs;      ///< per polygon two per corner; empty if there are none
  std::vector<std::uint32_t> image_of;               ///< per polygon: index in `images`; empty if there are none
  std::vector<std::string> images;                   ///< names after "comment TextureFile"
};

/// Reads the text or the bytes of a PLY. Unknown elements and properties are skipped. `name` is for messages. Throws
/// FileError for truncated files, numbers that are not finite and indices out of range.
PlyFile read_ply(std::string_view bytes, const std::filesystem::path& name);

}  // namespace rebake
