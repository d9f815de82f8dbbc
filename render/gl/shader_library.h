#pragma once

#include <string>

namespace rebake::gl {

/// Source of a shader: a #version line, `preamble` (defines and generated functions), and the file `name` with its
/// `#include "name"` lines resolved. Looks in the installation first, then in the source tree. Throws DeviceError if
/// there is no folder of shaders, FileError if the file is missing.
std::string shader_source(const std::string& name, const std::string& preamble);

}  // namespace rebake::gl
