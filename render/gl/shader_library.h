#pragma once

#include <string>

namespace rebake::gl {

/// The text of a file in shaders/, with its `#include "name"` lines resolved, behind a #version line and `preamble`
/// (defines and generated functions). Looks beside the installed program first, then in the source tree. Throws
/// DeviceError when it is not found.
std::string shader_source(const std::string& name, const std::string& preamble);

}  // namespace rebake::gl
