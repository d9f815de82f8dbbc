#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// A file as it is when it is read.
SourceFile source_file(const std::string& name, std::string_view bytes);

/// The bytes of a source file, if they have not changed since it was read; nothing if they have, or if it is gone.
std::optional<std::string> unchanged_bytes(const Origin& origin, const SourceFile& file);

/// The names of a folder's scene files: those that `files` gives, or if it throws FileError because the scene is
/// damaged, all that could be one by their name.
std::set<std::string> names_of_scene(const std::filesystem::path& folder,
                                     std::vector<std::filesystem::path> (*files)(const std::filesystem::path& folder),
                                     bool (*is_file_name)(const std::string& name));

}  // namespace rebake
