#include <glob.h>

#include <algorithm>
#include <cctype>

#include "editor/studies/dprt/animated_object.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/cage_file.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

// The name of a file's folder, as a part of file names.
std::string name_of(const fs::path& file) {
  std::string name = fs::absolute(file).lexically_normal().parent_path().filename().string();
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0 && c != '_' && c != '-'; }, '-');
  return name.empty() ? "meshes" : name;
}

}  // namespace

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
  AnimatedObject object{name_of(files.front()), {}, {}};
  for (const fs::path& file : files) {
    const Cage mesh = read_triangles(file);
    if (object.frames.empty())
      object.rest = {mesh.vertices, mesh.faces};
    else if (mesh.faces != object.rest.faces || mesh.vertices.size() != object.rest.vertices.size())
      throw FileError(file, "has other triangles than " + files.front().filename().string());
    for (const Vec3& p : mesh.vertices)
      if (!p.allFinite()) throw FileError(file, "has a vertex that is not finite");
    object.frames.push_back(mesh.vertices);
  }
  return object;
}

}  // namespace rebake
