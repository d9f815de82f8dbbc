#include "mesh_ops/formats/cameras/camera_formats.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/formats/cameras/camera_path_json.h"
#include "mesh_ops/formats/cameras/colmap.h"
#include "mesh_ops/formats/cameras/json_file.h"
#include "mesh_ops/formats/cameras/poses_bounds.h"
#include "mesh_ops/formats/cameras/transforms_json.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

// The file itself, or the file of this name in a folder.
fs::path file_at(const fs::path& path, const char* name) {
  std::error_code error;
  return fs::is_directory(path, error) ? path / name : path;
}

// Whether the path is a JSON file with a list of this name, or a folder with such a file `name`.
bool has_list(const fs::path& path, const char* name, const char* list) {
  const fs::path file = file_at(path, name);
  std::error_code error;
  if (file.extension() != ".json" || !fs::is_regular_file(file, error)) return false;
  try {
    const nlohmann::json object = read_json_object(file);
    const auto found = object.find(list);
    return found != object.end() && found->is_array();
  } catch (const FileError&) {
    return file.filename() == name;  // read() reports the error
  }
}

constexpr char transforms[] = "transforms.json";
constexpr char poses[] = "poses_bounds.npy";
constexpr char camera_path[] = "camera_path.json";
constexpr char ngp_path[] = "base_cam.json";

// The file transforms.json of a folder, or where only that exists, the training cameras of NeRF's synthetic scenes.
fs::path transforms_file(const fs::path& path) {
  const fs::path file = file_at(path, transforms);
  std::error_code error;
  if (fs::exists(file, error) || file == path) return file;
  const fs::path train = path / "transforms_train.json";
  return fs::exists(train, error) ? train : file;
}

template <const char* name>
std::vector<fs::path> single_file(const fs::path& path) {
  return {file_at(path, name)};
}

const CameraFormat all_formats[] = {
    {"transforms", "NeRF transforms", transforms, WorldUp::z,
     [](const fs::path& path) { return has_list(transforms_file(path), transforms, "frames"); },
     [](const fs::path& path, std::vector<std::string>& notes) {
       const fs::path file = transforms_file(path);
       if (file != path && file.filename() != transforms)
         notes.push_back(fmt::format("reads {} of the folder; name a file to read others", file.filename().string()));
       return read_transforms(file, notes);
     },
     [](const fs::path& path) { return std::vector{transforms_file(path)}; }, transforms_text},
    {"colmap", "COLMAP model", "folder with cameras and images as .bin or .txt", WorldUp::y,
     [](const fs::path& path) { return !colmap_folder(path).empty(); }, read_colmap, colmap_files, nullptr},
    {"poses_bounds", "LLFF poses", poses, WorldUp::y,
     [](const fs::path& path) {
       std::error_code error;
       const fs::path file = file_at(path, poses);
       return file.extension() == ".npy" && fs::is_regular_file(file, error);
     },
     [](const fs::path& path, std::vector<std::string>& notes) {
       return read_poses_bounds(file_at(path, poses), notes);
     },
     single_file<poses>, nullptr},
    {"nerfstudio_path", "nerfstudio camera path", camera_path, WorldUp::z,
     [](const fs::path& path) { return has_list(path, camera_path, "camera_path"); },
     [](const fs::path& path, std::vector<std::string>& notes) {
       return read_nerfstudio_path(file_at(path, camera_path), notes);
     },
     single_file<camera_path>, nerfstudio_path_text},
    {"ngp_path", "instant-ngp camera path", ngp_path, WorldUp::z,
     [](const fs::path& path) { return has_list(path, ngp_path, "path"); },
     [](const fs::path& path, std::vector<std::string>& notes) {
       return read_ngp_path(file_at(path, ngp_path), notes);
     },
     single_file<ngp_path>, nullptr},
};

}  // namespace

std::span<const CameraFormat> camera_formats() { return all_formats; }

const CameraFormat* camera_format_at(const fs::path& path) {
  for (const CameraFormat& format : camera_formats())
    if (format.recognises(path)) return &format;
  return nullptr;
}

const CameraFormat& camera_format_named(const std::string& name) {
  for (const CameraFormat& format : camera_formats())
    if (format.name == name) return format;
  throw FieldError("format",
                   fmt::format("\"{}\" is not known (known: {})", name, fmt::join(camera_format_names(), ", ")));
}

const CameraFormat& camera_format_for(const fs::path& path, const std::string& format) {
  if (!fs::exists(path)) throw FileError(path, "does not exist");
  const CameraFormat* const found = format.empty() ? camera_format_at(path) : &camera_format_named(format);
  if (found == nullptr) {
    std::vector<std::string> known;
    for (const CameraFormat& one : camera_formats()) known.push_back(fmt::format("{} ({})", one.title, one.marker));
    throw FileError(path, fmt::format("holds no cameras in a known format: {}", fmt::join(known, ", ")));
  }
  if (!found->recognises(path)) throw FileError(path, fmt::format("is not in the format {}", found->title));
  return *found;
}

std::vector<PhotoCamera> read_cameras(const fs::path& path, const std::string& format, std::optional<WorldUp> up,
                                      std::vector<std::string>& notes) {
  const CameraFormat& found = camera_format_for(path, format);
  return with_y_up(found.read(path, notes), up.value_or(found.up));
}

fs::path camera_root(const fs::path& path, const std::string& format) {
  const CameraFormat* const found = format.empty() ? camera_format_at(path) : &camera_format_named(format);
  if (found == nullptr || !found->recognises(path)) return path;
  const std::vector<fs::path> files = found->files(path);
  return files.size() == 1 ? files.front() : files.front().parent_path();
}

std::uint64_t camera_hash(const fs::path& path) {
  std::vector<std::string> notes;
  std::string text;
  for (const PhotoCamera& camera : camera_format_for(path, "").read(path, notes)) {
    text += fmt::format("{}\n{} {} {}", camera.name, camera.width, camera.height, camera.distortion.fisheye);
    const auto add = [&](const auto& values) {
      for (const double value : values) text += fmt::format(" {}", value);
    };
    add(camera.axes.reshaped());
    add(camera.eye);
    add(camera.focal);
    add(camera.center);
    add(camera.distortion.radial);
    add(camera.distortion.divisor);
    add(camera.distortion.tangential);
    text += fmt::format("\n{}\n", camera.mask.string());
  }
  // Films follow the rate of a camera path. That of most files was not part of the hash in earlier versions.
  constexpr double usual_rate = 24;
  if (&camera_format_for(path, "") == &camera_format_named("nerfstudio_path"))
    if (const auto rate = nerfstudio_path_rate(file_at(path, camera_path)); rate && *rate != usual_rate)
      text += fmt::format("{}\n", *rate);
  return content_hash(text);
}

std::vector<std::string> camera_format_names() {
  std::vector<std::string> names;
  for (const CameraFormat& format : camera_formats()) names.emplace_back(format.name);
  return names;
}

std::vector<std::string> written_camera_formats() {
  std::vector<std::string> names;
  for (const CameraFormat& format : camera_formats())
    if (format.write != nullptr) names.emplace_back(format.name);
  return names;
}

}  // namespace rebake
