#include "editor/document/sources.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>

#include "editor/edits/nodes/import.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/formats/scene_files.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

// The way from a folder to a source in it, "." for itself; nothing for one elsewhere.
std::optional<fs::path> way_to(const fs::path& source, const fs::path& folder) {
  const fs::path rest = absolute_path(source).lexically_relative(absolute_path(folder));
  return rest.empty() || *rest.begin() == ".." ? std::nullopt : std::optional(rest);
}

}  // namespace

namespace {

// The link that says most about where a source lies: the longest.
const Relinked::value_type* link_for(const fs::path& source, const Relinked& links) {
  const Relinked::value_type* chosen = nullptr;
  for (const Relinked::value_type& link : links)
    if (way_to(source, link.first) && (chosen == nullptr || way_to(link.first, chosen->first))) chosen = &link;
  return chosen;
}

}  // namespace

fs::path relinked(const fs::path& source, const Relinked& links) {
  const Relinked::value_type* link = link_for(source, links);
  if (link == nullptr) return source;
  const fs::path way = *way_to(source, link->first);
  return way == "." ? absolute_path(link->second) : absolute_path(link->second) / way;
}

void check_links(const Relinked& links, const std::vector<fs::path>& sources) {
  for (const Relinked::value_type& link : links) {
    const bool used = std::any_of(sources.begin(), sources.end(),
                                  [&](const fs::path& source) { return way_to(source, link.first).has_value(); });
    std::string known;
    for (const fs::path& source : std::set(sources.begin(), sources.end())) known += "\n  " + source.string();
    if (!used)
      throw FieldError("source", fmt::format("nothing was imported from \"{}\"{}", link.first.string(),
                                             known.empty() ? "" : "; these were:" + known));
  }
}

std::string trouble_with(const fs::path& source, const std::string& content, const Relinked& links) {
  const fs::path where = relinked(source, links);
  const std::string at = where == source ? "" : fmt::format(" (looked for at {})", where.string());
  std::error_code error;
  if (!fs::exists(where, error)) return at.empty() ? "is not there any more" : "is not there" + at;
  if (hash_text(folder_hash(where)) == content) return "";
  return at.empty() ? "has changed since it was imported" : "is not what was imported" + at;
}

Edit completed(const Edit& edit) {
  if (!edit.is<Import>()) return edit;
  Import import = *edit.as<Import>();
  if (import.path.empty()) throw FieldError("path", "is empty");
  import.path = absolute_path(import.path).string();
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
