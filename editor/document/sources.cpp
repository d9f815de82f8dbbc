#include "editor/document/sources.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "editor/edits/nodes/import.h"
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

std::optional<EditSource> source_of(const Edit& edit) {
  if (edit.type().source == nullptr) return std::nullopt;
  const EditSource source = edit.type().source(edit.value());
  return source.path.empty() ? std::nullopt : std::optional(source);
}

nlohmann::json* source_field(nlohmann::json& edit) {
  if (!edit.is_object()) return nullptr;
  const std::string op = edit.value("op", "");
  // A light with the effects "none" reads no picture.
  if (edit.contains("effects") && edit.at("effects") == nlohmann::json::array({"none"})) return nullptr;
  for (const EditType* const type : edit_types()) {
    if (op != type->op || type->source_field == nullptr) continue;
    const auto found = edit.find(type->source_field);
    return found == edit.end() || *found == "" ? nullptr : &*found;
  }
  return nullptr;
}

std::string source_problem(const fs::path& source, const std::string& content, const SourceLinks& links) {
  const fs::path where = resolved_source(source, content, links);
  const std::string at = where == source ? "" : fmt::format(" (expected at {})", where.string());
  std::error_code error;
  if (!fs::exists(where, error)) return at.empty() ? "no longer exists" : "does not exist" + at;
  if (hash_text(content_hash_at(where)) == content) return "";
  return at.empty() ? "has changed since it was imported" : "has another content than the imported source" + at;
}

std::vector<fs::path> input_files_of(nlohmann::json edit) {
  std::vector<fs::path> files;
  const std::string op = edit.value("op", "");
  const auto types = edit_types();
  const auto type = std::find_if(types.begin(), types.end(), [&](const EditType* one) { return op == one->op; });
  if (type != types.end() && (*type)->input_files != nullptr) {
    edit.erase("node");
    files = (*type)->input_files(read_edit(edit, {}).value());
  }
  if (const auto mesh = edit.find("mesh"); mesh != edit.end() && mesh->is_string())
    files.emplace_back(mesh->get<std::string>());
  return files;
}

Edit completed(const Edit& edit) {
  if (edit.is<Import>() && edit.as<Import>()->path.empty()) throw FieldError("path", "is empty");
  const std::optional<EditSource> source = source_of(edit);
  if (!source) return edit;
  EditSource whole{absolute_path(source->path), source->content};
  std::error_code error;
  const fs::path there = scene_root(whole.path);
  // The edit itself reports a missing source.
  if (whole.content.empty() && (fs::is_directory(there, error) || fs::is_regular_file(there, error)))
    whole.content = hash_text(content_hash_at(whole.path));
  return edit.type().with_source(edit.value(), whole);
}

void add_sources(SourceGuard& guard, const std::vector<Edit>& edits) {
  for (const Edit& edit : edits) {
    const auto source = source_of(edit);
    if (!source) continue;
    if (edit.type().input_files != nullptr)
      for (const fs::path& file : edit.type().input_files(edit.value())) guard.add_file(file);
    else
      protect_input(guard, source->path);
  }
}

void add_sources(SourceGuard& guard, const Scene& scene) {
  for (const PlacedNode& placed : placed_nodes(scene))
    if (placed.node->object && placed.node->object->origin) protect_input(guard, placed.node->object->origin->folder);
}

}  // namespace rebake
