#include "mesh_ops/formats/cameras/photographs.h"

#include <algorithm>

#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/cameras/camera_formats.h"
#include "mesh_ops/formats/cameras/mask_images.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

// The file with this name in a folder or elsewhere; its extension may be missing. Empty if it is not there.
fs::path existing(const fs::path& folder, const std::string& name) {
  if (name.empty()) return {};
  for (const char* extension : {"", ".png", ".jpg", ".jpeg", ".JPG", ".PNG"}) {
    std::error_code error;
    if (fs::path path = folder / (name + extension); fs::is_regular_file(path, error)) return path;
  }
  return {};
}

// The folders that hold the first photographs: the capture's folder, those in it, such as images_4, and the same around
// it, for captures whose cameras are in a subfolder, as in nerfstudio's colmap/sparse/0.
std::vector<fs::path> photograph_folders(const fs::path& capture, const std::vector<PhotoCamera>& cameras) {
  constexpr std::size_t tried = 3;
  std::vector<fs::path> found;
  const auto add_if_used = [&](const fs::path& folder) {
    for (std::size_t k = 0; k < std::min(tried, cameras.size()); ++k)
      if (!existing(folder, cameras[k].name).empty()) return found.push_back(folder);
  };
  for (const fs::path& around : {capture, capture.parent_path()}) {
    add_if_used(around);
    std::error_code error;
    for (fs::directory_iterator it(around, error), end; !error && it != end; it.increment(error))
      if (it->is_directory(error)) add_if_used(it->path());
  }
  return found;
}

}  // namespace

fs::path photograph_at(const fs::path& folder, const std::string& name) {
  const fs::path inside = fs::path(name).lexically_normal();
  if (inside.empty() || inside.is_absolute() || *inside.begin() == "..") return {};
  return existing(folder, name);
}

fs::path capture_folder(const fs::path& camera_file) {
  std::error_code error;
  fs::path folder = fs::absolute(camera_file).lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();
  if (!fs::is_directory(folder, error)) folder = folder.parent_path();
  const std::string name = folder.filename().string();
  const bool is_number = !name.empty() && name.find_first_not_of("0123456789") == std::string::npos;
  if (is_number && folder.parent_path().filename() == "sparse") folder = folder.parent_path();
  return folder.filename() == "sparse" ? folder.parent_path() : folder;
}

std::vector<fs::path> capture_files(const fs::path& camera_file, const std::vector<PhotoCamera>& cameras) {
  const fs::path folder = capture_folder(camera_file);
  std::vector<fs::path> files;
  const auto add = [&](const fs::path& file) {
    if (!file.empty()) files.push_back(file);
  };
  for (const PhotoCamera& camera : cameras) add(existing(folder, camera.mask.string()));
  for (const fs::path& place : photograph_folders(folder, cameras))
    for (const PhotoCamera& camera : cameras) add(existing(place, camera.name));
  for (const fs::path& mask : mask_files(cameras, folder, folder / "masks")) add(mask);
  return files;
}

std::vector<fs::path> named_files(const fs::path& camera_file, const std::vector<PhotoCamera>& cameras) {
  const fs::path folder = capture_folder(camera_file);
  std::vector<fs::path> files;
  for (const PhotoCamera& camera : cameras)
    if (fs::path file = photograph_at(folder, camera.name); !file.empty()) files.push_back(std::move(file));
  for (const PhotoCamera& camera : cameras)
    if (std::error_code error; !camera.mask.empty() && fs::is_regular_file(folder / camera.mask, error))
      files.push_back(folder / camera.mask);
  return files;
}

std::vector<fs::path> protected_files(const fs::path& camera_file, const std::vector<PhotoCamera>& cameras) {
  const fs::path folder = capture_folder(camera_file);
  std::vector<fs::path> files = named_files(camera_file, cameras);
  std::error_code error;
  const fs::path place_of_cameras =
      fs::is_directory(camera_file, error) ? camera_file : fs::absolute(camera_file).parent_path();
  const bool is_colmap = !fs::equivalent(folder, place_of_cameras, error);
  for (const PhotoCamera& camera : cameras)
    for (const fs::path& place : {folder, is_colmap ? folder / "images" : folder})
      if (fs::path file = existing(place, camera.name); !file.empty()) files.push_back(std::move(file));
  return files;
}

std::vector<fs::path> captured_files_at(const fs::path& folder, FilesOfCapture files_of) {
  std::error_code error;
  const fs::path whole = fs::weakly_canonical(folder, error);
  std::vector<fs::path> cameras, files;
  constexpr int levels = 3;
  fs::path around = whole;
  for (int level = 0; level < levels; ++level, around = around.parent_path())
    for (const char* place : {"", "sparse", "sparse/0", "colmap/sparse/0"}) cameras.push_back(around / place);
  // Further up, only files of the usual names.
  for (int level = levels; level < 2 * levels; ++level, around = around.parent_path())
    for (const char* name : {"transforms.json", "transforms_train.json", "sparse/0", "colmap/sparse/0"})
      if (fs::exists(around / name, error)) cameras.push_back(around / name);
  // Also files of other names, such as transforms_train.json.
  for (const fs::path& place : std::vector(cameras))
    if (fs::is_directory(place, error))
      for (auto entry = fs::directory_iterator(place, error); !error && entry != fs::end(entry); entry.increment(error))
        if (entry->path().extension() == ".json") cameras.push_back(entry->path());
  for (const fs::path& place : cameras) {
    if (!fs::exists(place, error) || camera_format_at(place) == nullptr) continue;
    try {
      std::vector<std::string> notes;
      for (fs::path& file : files_of(place, read_cameras(place, "", {}, notes))) files.push_back(std::move(file));
    } catch (const Error&) {
      // Unreadable cameras tell nothing about photographs.
    }
  }
  return files;
}

}  // namespace rebake
