#pragma once

#include <filesystem>
#include <optional>

namespace rebake {

/// A user folder of the XDG Base Directory Specification: the value of an environment variable such as XDG_CACHE_HOME
/// if it is an absolute path, else `below_home` in $HOME. Nothing if HOME is not an absolute path.
std::optional<std::filesystem::path> user_folder(const char* variable, const char* below_home);

}  // namespace rebake
