#pragma once

#include <filesystem>
#include <optional>

namespace rebake {

/// The user's folder for one purpose (XDG Base Directory Specification): what the variable names, where that is
/// absolute, else the one below the home folder; nothing where there is no home.
std::optional<std::filesystem::path> user_folder(const char* variable, const char* below_home);

}  // namespace rebake
