#pragma once

#include <string>

namespace rebake {

/// The type stub of the Python module, rebake.pyi: the edits come from the one table, so that editors know each one's
/// fields, types and defaults.
std::string python_stub();

}  // namespace rebake
