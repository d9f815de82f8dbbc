#include "mesh_ops/formats/scene_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/formats/cameras/camera_formats.h"
#include "mesh_ops/formats/formats.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

// False for folders that cannot be examined, for want of permission or other reasons: nothing reads them either.
bool is_scene(const fs::path& path) {
  try {
    return fs::is_directory(path) && format_at(path) != nullptr;
  } catch (const fs::filesystem_error&) {
    return false;
  }
}

// Hash of the names and contents of all files below a folder, as of films and web pages.
std::uint64_t files_hash(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files.push_back(entry.path().lexically_relative(folder));
  std::sort(files.begin(), files.end());
  std::string all;
  for (const fs::path& file : files)
    all += fmt::format("{} {:016x}\n", file.generic_string(), content_hash(read_file(folder / file)));
  return content_hash(all);
}

}  // namespace

fs::path scene_root(const fs::path& path) {
  const bool is_main_file = std::ranges::any_of(
      formats(), [&](const Format& format) { return format.is_folder && path.filename() == format.marker; });
  if (!is_main_file) return path;
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

std::vector<fs::path> scene_files(const fs::path& folder) {
  const Format* const format = format_at(folder);
  if (format == nullptr) return {};
  std::vector<fs::path> files = format->files(folder);
  std::sort(files.begin(), files.end(),
            [](const fs::path& a, const fs::path& b) { return a.generic_string() < b.generic_string(); });
  files.erase(std::unique(files.begin(), files.end()), files.end());
  return files;
}

std::uint64_t folder_hash(const fs::path& path) {
  const fs::path folder = scene_root(path);
  std::error_code error;
  if (!fs::is_directory(folder, error)) throw FileError(path, "does not exist, or is not a folder");
  std::string all;
  for (const fs::path& file : scene_files(folder))
    all += fmt::format("{} {:016x}\n", file.generic_string(), content_hash(read_file(folder / file)));
  return content_hash(all);
}

std::uint64_t content_hash_at(const fs::path& path) {
  const fs::path root = scene_root(path);
  std::error_code error;
  const bool is_folder = fs::is_directory(root, error);
  // Web pages have a scene.json, too, which is no scene.
  if (const Format* format = is_folder ? format_at(root) : nullptr;
      format != nullptr && (format->folder == nullptr || format->folder->is_genuine(root)))
    return folder_hash(path);
  if (camera_format_at(path) != nullptr) return camera_hash(path);
  if (is_folder) return files_hash(root);
  const std::vector<fs::path> beside = scene_files(path);
  if (beside.empty()) return content_hash(read_file(path));
  std::string all = fmt::format("{:016x}\n", content_hash(read_file(path)));
  for (const fs::path& file : beside)
    all += fmt::format("{} {:016x}\n", file.generic_string(), content_hash(read_file(path.parent_path() / file)));
  return content_hash(all);
}

std::uint64_t output_hash_at(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error) ? content_hash(read_file(path)) : content_hash_at(path);
}

void refuse_foreign_content(const fs::path& folder) {
  const auto refuse = [&](const fs::path& path) {
    throw FileError(
        folder, fmt::format("contains \"{}\", which is not part of its scene; move it, or choose a new or empty folder",
                            path.lexically_relative(folder).string()));
  };
  std::set<std::string> own;
  std::map<std::string, bool> markers;  // whether some format that has this marker finds it genuine
  for (const Format& format : formats()) {
    if (format.folder == nullptr || !fs::exists(folder / format.marker)) continue;
    bool& genuine = markers[format.marker];
    if (!format.folder->is_genuine(folder)) continue;
    genuine = true;
    own.merge(format.folder->own_folders(folder));
  }
  for (const auto& [marker, genuine] : markers)
    if (!genuine) refuse(folder / marker);
  // A folder with the main files of two formats is read as one of them; the other is not part of its scene.
  if (markers.size() > 1)
    for (const auto& [marker, genuine] : markers)
      if (format_at(folder) == nullptr || marker != format_at(folder)->marker) refuse(folder / marker);
  const bool known = !markers.empty();
  // At the top, only files of the formats whose markers are there.
  std::map<fs::path, std::set<std::string>> files_in;
  const auto is_own_file = [&](const fs::path& file) {
    const fs::path place = file.parent_path();
    const auto [found, first] = files_in.try_emplace(place);
    if (first)
      for (const Format& format : formats())
        // Object folders are no Rebake scenes.
        if (format.folder != nullptr &&
            (place == folder ? markers.contains(format.marker) : std::string_view(format.marker) != "scene.json"))
          found->second.merge(format.folder->own_files(place));
    return found->second.contains(file.filename().string());
  };
  if (!known && !fs::is_empty(folder)) refuse(fs::directory_iterator(folder)->path());
  std::error_code error;
  for (auto it = fs::recursive_directory_iterator(folder, error); !error && it != fs::recursive_directory_iterator();
       it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (it->is_symlink()) refuse(it->path());
    if (it->is_directory() ? it.depth() == 0 && own.contains(name) : is_own_file(it->path())) continue;
    if (markers.contains(name) && !it->is_directory())
      throw FileError(it->path().parent_path(),
                      "has a damaged scene, and which files belong to it is unknown; choose a new or empty folder");
    refuse(it->path());
  }
  if (error) throw FileError(folder, "cannot be read: " + error.message());
}

void protect_scene(SourceGuard& guard, const fs::path& path) { guard.add(scene_root(path), is_scene); }

void protect_input(SourceGuard& guard, const fs::path& path, const std::string& role) {
  std::error_code error;
  if (scene_root(path) != path || !fs::is_regular_file(path, error)) return protect_scene(guard, path);
  guard.add_file(path, role);
  try {
    for (const fs::path& file : scene_files(path)) guard.add_file(path.parent_path() / file, role);
    if (const Format* const format = format_at(path); format != nullptr && format->unread_files != nullptr)
      for (const fs::path& file : format->unread_files(path)) guard.add_file(path.parent_path() / file, role);
  } catch (const Error&) {
    // A damaged file is protected itself; reading it reports the damage.
  }
}

void protect_scene_contents(SourceGuard& guard, const fs::path& folder, const std::string& role) {
  guard.add_contents(folder, role, is_scene);
}

}  // namespace rebake
