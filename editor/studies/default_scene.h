#pragma once

#include <filesystem>

namespace rebake {

/// Folder of the ficus sample: next to the installed program, otherwise in the source tree. Throws Error if neither
/// exists.
std::filesystem::path default_study_scene();

}  // namespace rebake
