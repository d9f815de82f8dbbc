#include "render/gl/shader_library.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <filesystem>
#include <sstream>

#include "mesh_ops/error.h"
#include "mesh_ops/formats/files.h"

namespace rebake::gl {

namespace fs = std::filesystem;

namespace {

fs::path shader_folder() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (!error) {
    const fs::path installed = program.parent_path().parent_path() / REBAKE_INSTALLED_SHADERS;
    if (fs::is_directory(installed, error)) return installed;
  }
  if (fs::is_directory(REBAKE_SOURCE_SHADERS, error)) return REBAKE_SOURCE_SHADERS;
  throw DeviceError(
      "the shaders are not found: install the program with cmake --install, or keep the source tree where it was "
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
  // 4.0 brings textureGather of any component.
  const bool gathers = epoxy_gl_version() >= 40;
  return fmt::format("#version {} core\n#define GATHERS {}\n", gathers ? 400 : 330, gathers ? 1 : 0) + preamble +
         resolved(shader_folder(), name);
}

}  // namespace rebake::gl
