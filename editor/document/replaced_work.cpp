#include "editor/document/replaced_work.h"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "editor/document/journal.h"
#include "editor/document/project.h"
#include "mesh_ops/base/counted.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/base/source_guard.h"
#include "mesh_ops/formats/cameras/photographs.h"
#include "mesh_ops/formats/formats.h"
#include "render/image.h"

namespace rebake {

namespace fs = std::filesystem;

bool holds_project(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error) && read_file(path).find("\"rebake_project\"") != std::string::npos;
}

namespace {

// Whether a file without the extension of projects is a project, for example a link to it. Only files that begin as
// JSON are read as a whole.
bool is_project_by_another_name(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return false;
  std::ifstream in(path, std::ios::binary);
  char first = 0;
  return (in >> std::ws).get(first) && first == '{' && holds_project(path);
}

// The folder's path without an ending such as _4, which nerfstudio gives to folders of smaller photographs.
std::string without_scale(const fs::path& folder) {
  const std::string name = folder.string();
  const std::size_t last = name.find_last_not_of("0123456789");
  return last != std::string::npos && last + 1 < name.size() && name[last] == '_' ? name.substr(0, last) : name;
}

// A picture is taken for a photograph or mask if the cameras name it, or another one in its folder.
void refuse_replacing_photographs(const fs::path& path, const fs::path& folder) {
  std::error_code error;
  const bool is_picture = is_picture_file(path);
  const std::string place = without_scale(fs::weakly_canonical(folder, error));
  for (const fs::path& file : captured_files_at(folder))
    if (fs::equivalent(file, path, error) ||
        (is_picture && without_scale(fs::weakly_canonical(file.parent_path(), error)) == place))
      throw FileError(path, "belongs to a capture: photographs or masks are in its folder; name another folder");
}

// Pictures among those of a film, also new ones, would count as the film's when it goes on.
void refuse_replacing_film(const fs::path& path) {
  const fs::path record = absolute_path(path).parent_path() / "film.json";
  const std::string name = path.stem().string();
  std::error_code error;
  if (name.empty() || name.find_first_not_of("0123456789") != std::string::npos) return;
  if (!fs::is_regular_file(record, error)) return;
  const nlohmann::json film = nlohmann::json::parse(read_file(record), nullptr, false);
  const bool is_frame = film.is_object() && film.contains("rebake_film") && film.contains("extension") &&
                        film.at("extension") == path.extension().string();
  if (is_frame || is_picture_file(path))
    throw FileError(path, "would be a picture of the film in its folder (film.json); name another folder");
}

void refuse_replacing_work_at(const fs::path& path) {
  Journal::refuse_overwriting(path);
  refuse_replacing_film(path);
  if (is_project_file(path) ? holds_project(path) : is_project_by_another_name(path))
    throw FileError(path, "is a project, whose edits would be lost; name another file");
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return;
  const fs::path folder = absolute_path(path).parent_path();
  if (const Format* format = format_at(folder))
    for (const fs::path& file : format->files(folder))
      if (fs::equivalent(folder / file, path, error))
        throw FileError(path, "is a file of the scene in its folder; name another file");
  // Rendered ones may be rendered again: a script may export cameras for its own pictures.
  if (!is_rendered_picture(path)) refuse_replacing_photographs(path, folder);
}

}  // namespace

void refuse_replacing_work(const fs::path& path) {
  refuse_dangling_link(path);
  refuse_replacing_work_at(path);
  // What a link leads to is replaced, not the link.
  if (const fs::path target = plain_path(path); target != absolute_path(path)) refuse_replacing_work_at(target);
}

void refuse_replacing_captured(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error)) return;
  for (const fs::path& file : captured_files_at(absolute_path(path).parent_path(), protected_files))
    if (fs::equivalent(file, path, error))
      throw FileError(path, "is a photograph or mask of the capture in its folder; name another folder");
}

void refuse_replacing_foreign(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error) || (fs::is_regular_file(path, error) && fs::file_size(path, error) == 0)) return;
  if (!holds_project(path))
    throw FileError(path, "exists and is not a project, so it is not replaced; choose another name");
  const nlohmann::json root = nlohmann::json::parse(read_file(path), nullptr, false);
  if (root.is_object() && root.contains("rebake_project") && root.at("rebake_project").is_number() &&
      root.at("rebake_project") > project_version)
    throw FileError(path, "was written by a newer version of Rebake, so it is not replaced; choose another name");
}

std::vector<std::string> edits_in(const fs::path& project) {
  std::vector<std::string> edits;
  if (!holds_project(project)) return edits;
  const nlohmann::json root = nlohmann::json::parse(read_file(project), nullptr, false);
  if (!root.is_object() || !root.contains("edits") || !root.at("edits").is_array()) return edits;
  for (const nlohmann::json& edit : root.at("edits")) edits.push_back(edit.dump());
  return edits;
}

void refuse_replacing_more(const fs::path& path, std::size_t edits) {
  std::error_code error;
  if (!fs::exists(path, error)) return;
  Journal::refuse_overwriting(path);
  const auto refuse = [&](const std::string& what) {
    throw FileError(path, what + ", so it is not replaced; choose another name, or remove it first");
  };
  if (!holds_project(path)) refuse("exists and is not a project");
  const nlohmann::json root = nlohmann::json::parse(read_file(path), nullptr, false);
  if (!root.is_object() || !root.contains("edits") || !root.at("edits").is_array())
    refuse("is a damaged project, which may contain more edits");
  const nlohmann::json& version = root.at("rebake_project");
  if (!version.is_number() || version > project_version) refuse("was written by a newer version of Rebake");
  if (const std::size_t there = root.at("edits").size(); there > edits)
    refuse(fmt::format("contains {}, more than the {} to be saved", counted(there, "edit"), edits));
}

}  // namespace rebake
