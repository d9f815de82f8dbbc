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

/// The names of a folder's scene files, which `files` gives; none if it throws FileError, because in a damaged scene
/// nobody knows which files belong to it.
std::set<std::string> names_of_scene(const std::filesystem::path& folder,
                                     std::vector<std::filesystem::path> (*files)(const std::filesystem::path& folder));

}  // namespace rebake
