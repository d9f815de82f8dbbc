#pragma once

#include <string>
#include <vector>

namespace rebake {

/// Opens the editor on folders, scenes or a project, and returns when it is closed. Throws DeviceError where no window
/// can be opened.
void run_editor(const std::vector<std::string>& paths);

}  // namespace rebake
