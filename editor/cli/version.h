#pragma once

#include <string>

namespace rebake {

/// "rebake 0.1.0 (3c19799)": the version, and the Git commit of the sources if they were built in a checkout ("+" for
/// uncommitted changes).
std::string program_version();

}  // namespace rebake
