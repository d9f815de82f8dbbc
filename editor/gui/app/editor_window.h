#pragma once

#include <string>
#include <vector>

namespace rebake {

/// Opens the editor window with baked folders, scenes or one project, and returns when the window is closed. Throws
/// DeviceError if no window can be opened.
void run_editor(const std::vector<std::string>& paths);

}  // namespace rebake
