#pragma once

#include <filesystem>

namespace rebake {

/// Where the scenes lie that ship with Rebake: beside the installed program, else in the source tree. Empty when
/// neither is there.
std::filesystem::path sample_folder();

}  // namespace rebake
