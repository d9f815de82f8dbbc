#include <glob.h>

#include "editor/studies/dprt/animated_object.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/cage_file.h"

namespace rebake {

namespace fs = std::filesystem;

AnimatedObject animated_files(const std::string& pattern) {
  glob_t matches{};
  std::vector<fs::path> files;
  if (::glob(pattern.c_str(), GLOB_BRACE | GLOB_TILDE, nullptr, &matches) == 0)
    files.assign(matches.gl_pathv, matches.gl_pathv + matches.gl_pathc);
  ::globfree(&matches);
  constexpr std::size_t least = 20;
  if (files.size() < least)
    throw Error("\"" + pattern + "\" fits " + std::to_string(files.size()) + " files; at least " +
                std::to_string(least) + " frames are needed, of which every tenth is held out");
  AnimatedObject object{fs::absolute(files.front()).parent_path().filename().string(), {}, {}};
  for (const fs::path& file : files) {
    const Cage mesh = read_triangles(file);
    if (object.frames.empty())
      object.rest = {mesh.vertices, mesh.faces};
    else if (mesh.faces != object.rest.faces || mesh.vertices.size() != object.rest.vertices.size())
      throw FileError(file, "has other triangles than " + files.front().filename().string());
    object.frames.push_back(mesh.vertices);
  }
  return object;
}

}  // namespace rebake
