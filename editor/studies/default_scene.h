#pragma once

#include <filesystem>

namespace rebake {

/// The ficus that ships with Rebake: beside the installed program, else in the source tree. Throws Error when neither
/// is there.
std::filesystem::path default_study_scene();

}  // namespace rebake
