#pragma once

#include <filesystem>
#include <memory>
#include <string_view>
#include <vector>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// Reads a PLY, ASCII or binary: polygons with texture coordinates per vertex (s t, u v) or per face (texcoord) and the
/// image that a comment "TextureFile NAME" names. Without an image, each triangle gets the mean colour of its vertices,
/// or white. Throws FileError.
std::shared_ptr<const BakedObject> read_ply_object(const std::filesystem::path& file);

/// The images that read_ply_object() reads, relative to the file's folder.
std::vector<std::filesystem::path> ply_files(const std::filesystem::path& file);

}  // namespace rebake
