#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// A path relative to `folder` that the file `named_in` refers to. Backslashes of Windows become slashes. Throws
/// FileError if the path is absolute or leaves the folder, also through links.
std::filesystem::path path_beside(const std::filesystem::path& folder, std::string name,
                                  const std::filesystem::path& named_in);

/// The bytes of a file that `named_in` refers to; `name` is relative to `folder`. Throws FileError, naming both.
std::string read_beside(const std::filesystem::path& folder, const std::filesystem::path& name,
                        const std::filesystem::path& named_in);

/// The origin of an object that was read from a single file.
std::shared_ptr<const Origin> origin_of_file(const std::filesystem::path& file, const char* format,
                                             std::vector<std::string> assumptions);

}  // namespace rebake
