#pragma once

#include <filesystem>

namespace rebake {

/// Opens a file in the program that the desktop uses for its kind, by xdg-open. Does nothing if that is not installed.
void open_in_default_program(const std::filesystem::path& file);

}  // namespace rebake
