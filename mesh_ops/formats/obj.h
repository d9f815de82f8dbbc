#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "mesh_ops/base/types.h"

namespace rebake {

/// Vertices (position and UV, one each) and triangles of one OBJ file.
struct ObjMesh {
  std::vector<Vec3> positions;
  std::vector<Vec2> uvs;  ///< v points up
  std::vector<Face> faces;
};

/// Reads the OBJ subset of the format: v, vt, f with texture coordinates. Polygons become fans of triangles, negative
/// indices count back from the last vertex, and corners that pair a position with several UVs are split. `name` is for
/// messages. Throws FileError with the line for anything out of range, not finite, or cut short.
ObjMesh read_obj(std::string_view text, const std::filesystem::path& name);

/// Writes faces [first_face, last_face) with the vertices they use. Values that six decimals hold exactly get
/// six decimals, as the exporter writes them; others get the digits that a round trip needs.
std::string write_obj(const std::vector<Vec3>& positions, const std::vector<Vec2>& uvs, const std::vector<Face>& faces,
                      std::size_t first_face, std::size_t last_face);

}  // namespace rebake
