#pragma once

#include <filesystem>
#include <memory>
#include <string_view>
#include <vector>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// Reads a glTF 2.0 file (.glb or .gltf): the triangles of the default scene with their nodes' transforms, and the base
/// colour of their materials. Skins, morph targets, animations, lights and cameras are skipped, which the assumptions
/// say. Throws FileError, also for extensions that are required and unknown.
std::shared_ptr<const BakedObject> read_gltf_object(const std::filesystem::path& file);

/// The buffers and images beside the file that read_gltf_object() reads, relative to its folder.
std::vector<std::filesystem::path> gltf_files(const std::filesystem::path& file);

}  // namespace rebake
