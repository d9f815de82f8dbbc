#include "render/gl/shader_library.h"

#include <dlfcn.h>
#include <epoxy/gl.h>
#include <fmt/format.h>

#include <filesystem>
#include <sstream>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "render/gl/objects.h"

namespace rebake::gl {

namespace fs = std::filesystem;

namespace {

fs::path shader_folder() {
  // If installed, shaders are below the same prefix as this code: bin/rebake, or the Python module some folders deeper.
  std::error_code error;
  Dl_info self{};
  if (::dladdr(reinterpret_cast<const void*>(&make_program), &self) != 0) {
    fs::path folder = fs::weakly_canonical(self.dli_fname, error).parent_path();
    for (int up = 0; up < 4; ++up) {
      folder = folder.parent_path();
      if (fs::is_directory(folder / REBAKE_INSTALLED_SHADERS, error)) return folder / REBAKE_INSTALLED_SHADERS;
    }
  }
  if (fs::is_directory(REBAKE_SOURCE_SHADERS, error)) return REBAKE_SOURCE_SHADERS;
  throw DeviceError(
      "shaders not found: install the program with cmake --install, or keep the source tree where it was "
      "built");
}

std::string resolved(const fs::path& folder, const std::string& name) {
  std::istringstream lines(read_file(folder / name));
  std::string out;
  for (std::string line; std::getline(lines, line);) {
    const std::string mark = "#include \"";
    if (line.starts_with(mark))
      out += resolved(folder, line.substr(mark.size(), line.rfind('"') - mark.size()));
    else
      out += line + '\n';
  }
  return out;
}

}  // namespace

std::string shader_source(const std::string& name, const std::string& preamble) {
  // OpenGL 4.0 added textureGather of any component.
  const bool gathers = epoxy_gl_version() >= 40;
  return fmt::format("#version {} core\n#define GATHERS {}\n", gathers ? 400 : 330, gathers ? 1 : 0) + preamble +
         resolved(shader_folder(), name);
}

}  // namespace rebake::gl
