#include "editor/document/sources.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "editor/edits/nodes/import.h"
#include "editor/edits/nodes/light.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/formats/scene_files.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

// Relative path from a folder to a source in it, "." for the folder itself; nothing if the source is elsewhere.
std::optional<fs::path> relative_path_in(const fs::path& source, const fs::path& folder) {
  const fs::path rest = absolute_path(source).lexically_relative(absolute_path(folder));
  return rest.empty() || *rest.begin() == ".." ? std::nullopt : std::optional(rest);
}

}  // namespace

namespace {

// The most specific (longest) old path among the links that contain a source; null if there is none.
const fs::path* old_path_of(const fs::path& source, const SourceLinks& links) {
  const fs::path* chosen = nullptr;
  for (const SourceLinks::value_type& link : links)
    if (relative_path_in(source, link.first) && (chosen == nullptr || relative_path_in(link.first, *chosen)))
      chosen = &link.first;
  return chosen;
}

// Whether a file or scene folder with this content hash is at the path.
bool holds(const fs::path& path, const std::string& content) {
  std::error_code error;
  if (!fs::exists(path, error)) return false;
  try {
    return hash_text(content_hash_at(path)) == content;
  } catch (const FileError&) {
    return false;
  }
}

}  // namespace

fs::path resolved_source(const fs::path& source, const std::string& content, const SourceLinks& links) {
  const fs::path* const old = old_path_of(source, links);
  if (old == nullptr) return source;
  const fs::path way = *relative_path_in(source, *old);
  std::vector<fs::path> places;
  for (auto [link, end] = links.equal_range(*old); link != end; ++link)
    places.push_back(way == "." ? absolute_path(link->second) : absolute_path(link->second) / way);
  places.push_back(source);
  const auto found = std::find_if(places.begin(), places.end(), [&](const fs::path& at) { return holds(at, content); });
  return found != places.end() ? *found : places.front();
}

void check_links(const SourceLinks& links, const std::vector<fs::path>& sources) {
  for (const SourceLinks::value_type& link : links) {
    const bool used = std::any_of(sources.begin(), sources.end(), [&](const fs::path& source) {
      return relative_path_in(source, link.first).has_value();
    });
    std::string known;
    for (const fs::path& source : std::set(sources.begin(), sources.end())) known += "\n  " + source.string();
    if (!used)
      throw FieldError("source", fmt::format("\"{}\" contains no source{}", link.first.string(),
                                             known.empty() ? "" : "; the sources are:" + known));
  }
}

namespace {

// A light with effects "none" reads no picture.
bool has_picture(const LightEdit& light) {
  return !light.picture.empty() && light.effects != std::vector<std::string>{"none"};
}

}  // namespace

std::uint64_t content_hash_at(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(scene_root(path), error) ? folder_hash(path) : content_hash(read_file(path));
}

std::optional<EditSource> source_of(const Edit& edit) {
  if (const auto* import = edit.as<Import>()) return EditSource{import->path, import->content};
  if (const auto* light = edit.as<LightEdit>(); light != nullptr && has_picture(*light))
    return EditSource{light->picture, light->content};
  return std::nullopt;
}

nlohmann::json* source_field(nlohmann::json& edit) {
  if (!edit.is_object()) return nullptr;
  const std::string op = edit.value("op", "");
  const bool off = edit.contains("effects") && edit.at("effects") == nlohmann::json::array({"none"});
  const char* const field = op == Import::op ? "path" : op == LightEdit::op && !off ? "picture" : "";
  const auto found = edit.find(field);
  return found == edit.end() || *found == "" ? nullptr : &*found;
}

std::string source_problem(const fs::path& source, const std::string& content, const SourceLinks& links) {
  const fs::path where = resolved_source(source, content, links);
  const std::string at = where == source ? "" : fmt::format(" (expected at {})", where.string());
  std::error_code error;
  if (!fs::exists(where, error)) return at.empty() ? "no longer exists" : "does not exist" + at;
  if (hash_text(content_hash_at(where)) == content) return "";
  return at.empty() ? "has changed since it was imported" : "has another content than the imported source" + at;
}

Edit completed(const Edit& edit) {
  if (edit.is<Import>() && edit.as<Import>()->path.empty()) throw FieldError("path", "is empty");
  const std::optional<EditSource> source = source_of(edit);
  if (!source) return edit;
  const std::string path = absolute_path(source->path).string();
  const auto content = [&](bool there) {
    // The edit itself reports a missing source.
    return source->content.empty() && there ? hash_text(content_hash_at(path)) : source->content;
  };
  std::error_code error;
  if (const auto* import = edit.as<Import>()) {
    Import whole = *import;
    whole.path = path;
    whole.content = content(fs::is_directory(scene_root(path), error));
    return whole;
  }
  LightEdit whole = *edit.as<LightEdit>();
  whole.picture = path;
  whole.content = content(fs::is_regular_file(path, error));
  return whole;
}

void add_sources(SourceGuard& guard, const std::vector<Edit>& edits) {
  for (const Edit& edit : edits)
    if (const auto* import = edit.as<Import>())
      protect_input(guard, import->path);
    else if (const auto source = source_of(edit))
      guard.add_file(source->path);
}

void add_sources(SourceGuard& guard, const Scene& scene) {
  for (const PlacedNode& placed : placed_nodes(scene))
    if (placed.node->object && placed.node->object->origin) protect_scene(guard, placed.node->object->origin->folder);
}

}  // namespace rebake
