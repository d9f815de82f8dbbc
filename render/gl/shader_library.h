#pragma once

#include <string>

namespace rebake::gl {

/// Source of a shader: a #version line, `preamble` (defines and generated functions), and the file `name` with its
/// `#include "name"` lines resolved. Looks in the installation first, then in the source tree. Throws DeviceError if
/// there is no folder of shaders, FileError if the file is missing.
std::string shader_source(const std::string& name, const std::string& preamble);

/// As shader_source(), for WebGL 2 (GLSL ES 3.00). Every macro that the file tests must be in `preamble`.
std::string web_shader_source(const std::string& name, const std::string& preamble);

/// The text of a file of the web page, `name` in render/web_page/viewer or in the installation. Throws DeviceError if
/// there is no such folder, FileError if the file is missing.
std::string web_page_file(const std::string& name);

}  // namespace rebake::gl
