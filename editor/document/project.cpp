#include "editor/document/project.h"

#include <fmt/format.h>

#include "mesh_ops/formats/files.h"

namespace rebake {

using nlohmann::json;
namespace fs = std::filesystem;

namespace {

constexpr int version = 1;

// What is wrong with a source, empty when it is as it was.
std::string trouble_with(const fs::path& path, const std::string& content) {
  std::error_code error;
  if (!fs::exists(path, error)) return "is not there any more";
  return fmt::format("{:016x}", folder_hash(path)) == content ? "" : "has changed since it was imported";
}

}  // namespace

bool is_project_file(const fs::path& path) {
  std::error_code error;
  return path.extension() == ".rebake" && fs::is_regular_file(path, error);
}

Edit completed(const Edit& edit) {
  Edit result = edit;
  if (auto* import = std::get_if<Import>(&result)) {
    import->path = fs::absolute(import->path).lexically_normal().string();
    // What is not there is reported by the import itself.
    const fs::path folder = fs::path(import->path).filename() == "scene.json" ? fs::path(import->path).parent_path()
                                                                              : fs::path(import->path);
    std::error_code error;
    if (import->content.empty() && fs::is_directory(folder, error))
      import->content = fmt::format("{:016x}", folder_hash(import->path));
  }
  return result;
}

void write_project(const fs::path& path, const std::vector<Edit>& edits, const std::vector<bool>& joined) {
  const fs::path folder = fs::absolute(path).lexically_normal().parent_path();
  json root = {{"rebake_project", version}, {"sources", json::array()}, {"edits", json::array()}};
  for (Edit edit : edits) {
    if (auto* import = std::get_if<Import>(&edit)) {
      import->path = fs::path(import->path).lexically_proximate(folder).generic_string();
      const json source = {{"path", import->path}, {"content", import->content}};
      if (std::find(root["sources"].begin(), root["sources"].end(), source) == root["sources"].end())
        root["sources"].push_back(source);
    }
    root["edits"].push_back(to_json(edit));
  }
  for (std::size_t k = 0; k < edits.size(); ++k)
    if (joined[k]) root["joined"].push_back(k + 1);
  write_file_atomically(path, root.dump(1) + '\n');
}

ReadProject read_project(const fs::path& path) {
  const fs::path folder = fs::absolute(path).lexically_normal().parent_path();
  ReadProject project;
  try {
    const json root = json::parse(read_file(path));
    if (!root.is_object() || !root.contains("rebake_project")) throw FileError(path, "is not a project of Rebake");
    if (root.at("rebake_project") != version)
      throw FileError(path, "was written by a newer version of Rebake; open it with that one");
    std::string troubles;
    for (const json& source : root.at("sources")) {
      const auto name = source.at("path").get<std::string>();
      if (const std::string trouble = trouble_with((folder / name).lexically_normal(), source.at("content"));
          !trouble.empty())
        troubles += fmt::format("\n  {} {}", name, trouble);
    }
    if (!troubles.empty())
      throw FileError(path,
                      "its sources are not as they were; put them back, or change their paths in the file:" + troubles);
    Scene scene;
    std::size_t number = 0;
    for (json line : root.at("edits")) {
      ++number;
      try {
        if (line.is_object() && line.value("op", "") == Import::op)
          line["path"] = (folder / line.at("path").get<std::string>()).lexically_normal().string();
        project.edits.push_back(read_edit(line, scene));
        if (const auto* import = std::get_if<Import>(&project.edits.back()); import && import->content.empty())
          throw FieldError("content", "is missing: without it a changed source would not be noticed");
        scene = rebake::apply(scene, project.edits.back());
      } catch (const Error& error) {
        throw FileError(path, fmt::format("edit {}: {}", number, error.what()));
      }
      project.scenes.push_back(scene);
    }
    project.joined.resize(project.edits.size());
    for (const json& one : root.value("joined", json::array())) {
      const auto k = one.get<std::size_t>();
      if (k < 2 || k > project.joined.size())
        throw FileError(path, fmt::format("joined: there is no edit {} that could be", k));
      project.joined[k - 1] = true;
    }
  } catch (const json::exception& error) {
    throw FileError(path, std::string("is not a valid project: ") + error.what());
  }
  return project;
}

}  // namespace rebake
