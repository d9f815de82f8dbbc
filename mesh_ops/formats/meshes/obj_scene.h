#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// Reads an OBJ with the materials of its MTL files: the image of map_Kd, or the colour Kd where there is none. Throws
/// FileError.
std::shared_ptr<const BakedObject> read_obj_object(const std::filesystem::path& file);

/// The MTL files and images that read_obj_object() reads, relative to the file's folder.
std::vector<std::filesystem::path> obj_files(const std::filesystem::path& file);

/// The existing pictures that the MTL files name, such as normal maps, relative to the file's folder; most are not
/// read.
std::vector<std::filesystem::path> obj_unread_files(const std::filesystem::path& file);

}  // namespace rebake
