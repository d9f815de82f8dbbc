#include "mesh_ops/formats/mobilenerf/source_file.h"

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/base/hash.h"

namespace rebake {

SourceFile source_file(const std::string& name, std::string_view bytes) {
  return {name, bytes.size(), content_hash(bytes)};
}

std::optional<std::string> unchanged_bytes(const Origin& origin, const SourceFile& file) {
  try {
    std::string bytes = read_file(origin.folder / file.name);
    if (bytes.size() == file.size && content_hash(bytes) == file.hash) return bytes;
  } catch (const FileError&) {
    // The file was moved or removed, so its contents are written from memory.
  }
  return std::nullopt;
}

std::set<std::string> names_of_scene(const std::filesystem::path& folder,
                                     std::vector<std::filesystem::path> (*files)(const std::filesystem::path& folder)) {
  try {
    std::set<std::string> names;
    for (const std::filesystem::path& file : files(folder)) names.insert(file.string());
    return names;
  } catch (const FileError&) {
    return {};
  }
}

}  // namespace rebake
