#pragma once

#include <filesystem>

namespace rebake {

/// Folder of the sample scenes: that of the installed program, else that of the source tree. Empty if neither exists.
std::filesystem::path sample_folder();

}  // namespace rebake
