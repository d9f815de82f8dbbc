#include "editor/document/sources.h"

#include "editor/edits/nodes/import.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/formats/scene_files.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

fs::path plain(const fs::path& path) {
  const fs::path normal = fs::absolute(path).lexically_normal();
  return normal.has_filename() ? normal : normal.parent_path();
}

}  // namespace

fs::path relinked(const fs::path& source, const Relinked& links) {
  const fs::path wanted = plain(source);
  for (const auto& [from, to] : links) {
    const fs::path rest = wanted.lexically_relative(plain(from));
    if (rest == ".") return plain(to);
    if (!rest.empty() && *rest.begin() != "..") return plain(to) / rest;
  }
  return source;
}

std::string trouble_with(const fs::path& source, const std::string& content) {
  std::error_code error;
  if (!fs::exists(source, error)) return "is not there any more";
  return hash_text(folder_hash(source)) == content ? "" : "has changed since it was imported";
}

Edit completed(const Edit& edit) {
  if (!edit.is<Import>()) return edit;
  Import import = *edit.as<Import>();
  import.path = fs::absolute(import.path).lexically_normal().string();
  std::error_code error;
  // What is not there is reported by the import itself.
  if (import.content.empty() && fs::is_directory(scene_folder_of(import.path), error))
    import.content = hash_text(folder_hash(import.path));
  return import;
}

void add_sources(SourceGuard& guard, const std::vector<Edit>& edits) {
  for (const Edit& edit : edits)
    if (const auto* import = edit.as<Import>()) guard.add(scene_folder_of(import->path));
}

void add_sources(SourceGuard& guard, const Scene& scene) {
  for (const PlacedNode& placed : placed_nodes(scene))
    if (placed.node->object && placed.node->object->origin) guard.add(placed.node->object->origin->folder);
}

}  // namespace rebake
