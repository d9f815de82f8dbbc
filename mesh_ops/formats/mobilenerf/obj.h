#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "mesh_ops/base/types.h"

namespace rebake {

/// Triangle mesh of one OBJ file; every vertex has one position and one UV.
struct ObjMesh {
  std::vector<Vec3> positions;
  std::vector<Vec2> uvs;  ///< v points up
  std::vector<Face> faces;
  std::vector<std::string> assumptions = {};  ///< skipped parts and decisions, with the first line of each kind
  bool needs_repair = false;                  ///< viewers would draw the file otherwise; exports must not copy it

  // Only with ObjReading::materials.
  std::vector<std::string> libraries = {};      ///< what follows mtllib: one name or several
  std::vector<std::string> materials = {};      ///< names after usemtl, first "" for faces before the first one
  std::vector<std::uint32_t> material_of = {};  ///< per face: index in `materials`
};

/// Options for OBJ files that are no part of a MobileNeRF folder.
struct ObjReading {
  bool materials = false;    ///< reads the names of materials, which are otherwise skipped
  bool missing_uvs = false;  ///< corners without texture coordinates get (0, 0) instead of an error
};

/// Reads v, vt and f with texture coordinates; all objects and groups are one mesh. Polygons become triangles
/// (cut_polygon), negative indices count back from the last vertex, positions with several UVs are duplicated, and a
/// backslash at the end of a line continues it. Lines, points, normals, materials, vertex colours and weights are
/// skipped. `name` is for messages. Throws FileError with the line for indices out of range, numbers that are not
/// finite, and truncated statements.
ObjMesh read_obj(std::string_view text, const std::filesystem::path& name, const ObjReading& reading = {});

/// Writes faces [first_face, last_face) with the vertices they use. Numbers that six decimals represent exactly get six
/// decimals, as in the published exporter; others get the digits that a round trip needs.
std::string write_obj(const std::vector<Vec3>& positions, const std::vector<Vec2>& uvs, const std::vector<Face>& faces,
                      std::size_t first_face, std::size_t last_face);

}  // namespace rebake
