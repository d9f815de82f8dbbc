#include "editor/document/project.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "mesh_ops/base/counted.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/base/hash.h"

namespace rebake {

using nlohmann::json;
namespace fs = std::filesystem;

namespace {

std::string checksum(json root) {
  root.erase("checksum");
  return hash_text(content_hash(root.dump()));
}

// The file's folder with symbolic links resolved, so that relative paths mean the same whatever name it is opened by.
fs::path real_folder_of(const fs::path& file) { return fs::weakly_canonical(fs::absolute(file)).parent_path(); }

fs::path source_path(const fs::path& folder, const json& name) {
  return (folder / name.get<std::string>()).lexically_normal();
}

void check_form(const fs::path& path, const json& root) {
  if (!root.is_object() || !root.contains("rebake_project")) throw FileError(path, "is not a Rebake project");
  const json& of = root.at("rebake_project");
  if (!of.is_number_unsigned() || of.get<std::uint64_t>() > project_version)
    throw FileError(path, "was written by a newer version of Rebake; open it with that version");
  for (const auto& [key, value] : root.items())
    if (key != "rebake_project" && key != "sources" && key != "edits" && key != "joined" && key != "replaces" &&
        key != "checksum")
      throw FileError(path, fmt::format("is damaged: \"{}\" is not a field of a project", key));
  if (root.contains("checksum") && root.at("checksum") != checksum(root))
    throw FileError(path,
                    "is damaged, or was edited by hand: the checksum is wrong. Remove \"checksum\" from the file to "
                    "open it anyway");
}

}  // namespace

bool is_project_file(const fs::path& path) {
  std::error_code error;
  return path.extension() == ".rebake" && fs::is_regular_file(path, error);
}

SavedProject write_project(const fs::path& path, const std::vector<History::Entry>& entries, const SourceGuard& guard,
                           const Progress& progress) {
  const fs::path folder = real_folder_of(path);
  json root = {{"rebake_project", project_version - 1}, {"sources", json::array()}, {"edits", json::array()}};
  for (std::size_t k = 0; k < entries.size(); ++k) {
    progress.at("saving", static_cast<double>(k) / static_cast<double>(entries.size()));
    root["edits"].push_back(to_json(entries[k].edit));
    if (entries[k].joined) root["joined"].push_back(k + 1);
    if (entries[k].replaced > 0) {
      root["rebake_project"] = project_version;
      root["replaces"].push_back({k + 1, entries[k].replaced});
    }
    const auto read = source_of(entries[k].edit);
    if (!read) continue;
    // The last link of a file keeps its name, by which formats are recognised; caches link names to contents.
    std::error_code not_there;
    const fs::path source =
        fs::is_regular_file(read->path, not_there)
            ? fs::weakly_canonical(fs::absolute(read->path).parent_path()) / fs::path(read->path).filename()
            : fs::weakly_canonical(read->path);
    const std::string relative = source.lexically_proximate(folder).generic_string();
    *source_field(root["edits"].back()) = relative;
    const json entry = {{"path", relative}, {"content", read->content}};
    if (std::find(root["sources"].begin(), root["sources"].end(), entry) == root["sources"].end())
      root["sources"].push_back(entry);
  }
  SavedProject saved;
  const auto warn = [&](std::string warning) {
    saved.opens = false;
    saved.warnings.push_back(std::move(warning));
  };
  for (const json& source : root["sources"]) {
    const fs::path read = source_path(folder, source.at("path"));
    const std::string trouble = source_problem(read, source.at("content"), {});
    if (trouble.empty()) continue;
    warn(fmt::format(
        "{} {}: the project cannot be opened without the original; save a scene folder to keep the present scene",
        read.string(), trouble));
  }
  for (const History::Entry& entry : entries) {
    const EditType& type = entry.edit.type();
    // Missing sources are known by now.
    const std::string trouble =
        type.input_problem != nullptr && saved.opens ? type.input_problem(entry.edit.value()) : "";
    if (!trouble.empty())
      warn(fmt::format("{}; without them the project cannot be opened; save a scene folder to keep the present scene",
                       trouble));
  }
  try {
    root["checksum"] = checksum(root);
    write_file_atomically(path, root.dump(1) + '\n', guard);
  } catch (const json::type_error&) {
    throw FileError(path, "cannot be written: a name or path is not valid UTF-8");
  }
  return saved;
}

std::vector<fs::path> project_sources(const fs::path& path) {
  const json root = json::parse(read_file(path), nullptr, false);
  std::vector<fs::path> sources;
  if (!root.is_object() || !root.contains("sources") || !root.at("sources").is_array()) return sources;
  for (const json& source : root.at("sources"))
    if (source.is_object() && source.contains("path") && source.at("path").is_string())
      sources.push_back(source_path(real_folder_of(path), source.at("path")));
  // Masks, photographs and the like, which edits read besides.
  for (json edit : root.value("edits", json::array())) {
    try {
      if (json* const source = source_field(edit); source != nullptr && source->is_string())
        *source = source_path(real_folder_of(path), *source).string();
      for (fs::path& file : input_files_of(edit)) sources.push_back(std::move(file));
    } catch (const std::exception&) {
      continue;  // opening the project reports it
    }
  }
  return sources;
}

void read_project(const fs::path& path, const EditVisitor& each, const SourceLinks& links, const Progress& progress) {
  const fs::path folder = real_folder_of(path);
  try {
    const json root = json::parse(read_file(path));
    check_form(path, root);
    std::string troubles;
    std::vector<SourcesUnavailable::Source> gone;
    std::vector<fs::path> imports;
    for (const json& source : root.at("sources")) {
      const fs::path& imported = imports.emplace_back(source_path(folder, source.at("path")));
      const std::string trouble = source_problem(imported, source.at("content"), links);
      if (trouble.empty()) continue;
      troubles += fmt::format("\n  {} {}", imported.string(), trouble);
      gone.push_back({imported, source.at("content"), trouble});
    }
    check_links(links, imports);
    if (!gone.empty())
      throw SourcesUnavailable(
          path,
          "sources are missing or have changed; restore them, or give their new locations (in the editor, or by "
          "rebake recover P.rebake --source OLD=NEW -o Q.rebake):" +
              troubles,
          gone);
    std::vector<bool> joined(root.at("edits").size());
    for (const json& one : root.value("joined", json::array())) {
      const auto k = one.get<std::size_t>();
      if (k < 2 || k > joined.size())
        throw FileError(path, fmt::format("joined: {} is not the number of an edit from 2 on", k));
      joined[k - 1] = true;
    }
    // Scenes that a later edit with "replaces" starts from, by the number of edits before them.
    std::map<std::size_t, Scene> bases;
    std::vector<std::size_t> replaced(joined.size(), 0);
    for (const json& one : root.value("replaces", json::array())) {
      const auto k = one.at(0).get<std::size_t>(), count = one.at(1).get<std::size_t>();
      if (k < 2 || k > replaced.size() || count >= k)
        throw FileError(path, fmt::format("replaces: edit {} cannot replace {}", k, counted(count, "edit")));
      replaced[k - 1] = count;
      bases[k - 1 - count] = {};
    }
    Scene scene;
    std::size_t number = 0;
    for (json line : root.at("edits")) {
      if (const auto base = bases.find(number); base != bases.end()) base->second = scene;
      if (replaced[number] > 0) scene = bases.at(number - replaced[number]);
      progress.at("opening", static_cast<double>(number++) / static_cast<double>(root.at("edits").size()));
      try {
        if (json* const source = source_field(line))
          *source = resolved_source(source_path(folder, *source), line.value("content", ""), links).string();
        const Edit edit = read_edit(line, scene);
        if (const auto source = source_of(edit); source && source->content.empty())
          throw FieldError("content", "is missing: the content hash is needed to detect a changed source");
        scene = rebake::apply(scene, edit, progress).scene;
        each({edit, joined[number - 1], replaced[number - 1]}, scene);
      } catch (const Cancelled&) {
        throw;
      } catch (const Error& error) {
        throw FileError(path, fmt::format("edit {}: {}", number, error.what()));
      }
    }
  } catch (const json::exception& error) {
    throw FileError(path, std::string("is not a valid project: ") + error.what());
  }
}

}  // namespace rebake
