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

// A folder of the installation; that of the source tree if this code is not installed.
fs::path data_folder(const char* installed, const char* source, const char* contents) {
  // If installed, the folder is below the same prefix as this code: bin/rebake, or the Python module some folders
  // deeper.
  std::error_code error;
  Dl_info self{};
  if (::dladdr(reinterpret_cast<const void*>(&make_program), &self) != 0) {
    fs::path folder = fs::weakly_canonical(self.dli_fname, error).parent_path();
    for (int up = 0; up < 4; ++up) {
      folder = folder.parent_path();
      if (fs::is_directory(folder / installed, error)) return folder / installed;
    }
  }
  if (fs::is_directory(source, error)) return source;
  throw DeviceError(fmt::format(
      "{} not found: install the program with cmake --install, or keep the source tree where it was built", contents));
}

fs::path shader_folder() { return data_folder(REBAKE_INSTALLED_SHADERS, REBAKE_SOURCE_SHADERS, "shaders"); }

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

std::string web_shader_source(const std::string& name, const std::string& preamble) {
  return "#version 300 es\nprecision highp float;\nprecision highp int;\nprecision highp sampler2D;\n"
         "precision highp usampler2D;\n#define GATHERS 0\n#define DECODER_BUFFER 0\n#define CODED_TEXELS 0\n" +
         preamble + resolved(shader_folder(), name);
}

std::string web_page_file(const std::string& name) {
  return read_file(data_folder(REBAKE_INSTALLED_WEB_PAGE, REBAKE_SOURCE_WEB_PAGE, "files of the web page") / name);
}

}  // namespace rebake::gl
