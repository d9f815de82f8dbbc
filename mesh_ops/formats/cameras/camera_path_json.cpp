#include "mesh_ops/formats/cameras/camera_path_json.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>

#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/cameras/camera_formats.h"
#include "mesh_ops/formats/cameras/camera_mark.h"
#include "mesh_ops/formats/cameras/json_file.h"

namespace rebake {

using nlohmann::json;

namespace {

constexpr double radians_per_degree = std::numbers::pi / 180;

// Numbers of a list with this length.
std::vector<double> numbers(const json& object, const char* key, std::size_t length) {
  const auto found = object.find(key);
  if (found == object.end()) throw FieldError(key, "is missing");
  if (!found->is_array() || found->size() != length)
    throw FieldError(key, fmt::format("must be a list of {} numbers", length));
  std::vector<double> values;
  for (const json& entry : *found) {
    if (!entry.is_number()) throw FieldError(key, fmt::format("must be a list of {} numbers", length));
    values.push_back(entry.get<double>());
  }
  return values;
}

double number(const json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end()) throw FieldError(key, "is missing");
  if (!found->is_number()) throw FieldError(key, "must be a number");
  return found->get<double>();
}

void set_lens(PhotoCamera& camera, double fov_degrees, int width, int height) {
  if (!(fov_degrees > 0 && fov_degrees < 180)) throw FieldError("fov", "must lie between 0 and 180 degrees");
  const double focal = height / (2 * std::tan(fov_degrees * radians_per_degree / 2));
  camera.width = width;
  camera.height = height;
  camera.focal = {focal, focal};
  camera.center = Vec2(width, height) / 2;
  check(camera);
}

// Reads each entry of a list; errors get the file and the entry's number.
template <class Read>
std::vector<PhotoCamera> read_entries(const std::filesystem::path& file, const json& object, const char* key,
                                      const Read& read) {
  const auto list = object.find(key);
  if (list == object.end() || !list->is_array() || list->empty())
    throw FileError(file, fmt::format("has no list \"{}\" with cameras", key));
  std::vector<PhotoCamera> cameras;
  for (const json& entry : *list) {
    try {
      if (!entry.is_object()) throw FieldError(key, "must contain objects");
      cameras.push_back(read(entry));
    } catch (const FieldError& error) {
      throw FileError(file, fmt::format("camera {}: {}", cameras.size(), error.what()));
    }
  }
  return cameras;
}

}  // namespace

std::vector<PhotoCamera> read_nerfstudio_path(const std::filesystem::path& file, std::vector<std::string>& notes) {
  const json object = read_json_object(file);
  const auto stated = [&](const char* key, double missing) {
    const double value = object.contains(key) ? number(object, key) : missing;
    if (!(value >= 1 && value <= 1 << 20)) throw FieldError(key, "is not possible");
    return value;
  };
  double width = 0, height = 0;
  try {
    height = stated("render_height", 1080);
    width = stated("render_width", height);
  } catch (const FieldError& error) {
    throw FileError(file, error.what());
  }
  const auto kind = object.find("camera_type");
  if (kind != object.end() && *kind != "perspective") throw FileError(file, "has a camera_type other than perspective");
  if (!object.contains("render_height"))
    notes.emplace_back("the file does not state the picture size; 1080 rows are assumed");
  notes.emplace_back(
      "the path is in nerfstudio's own frame, which may be turned and scaled against that of the capture");
  return read_entries(file, object, "camera_path", [&](const json& entry) {
    const std::vector<double> m = numbers(entry, "camera_to_world", 16);
    PhotoCamera camera;
    Mat3 columns;
    columns << m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10];
    camera.axes = rotation_of_pose(columns, "camera_to_world");
    camera.eye = {m[3], m[7], m[11]};
    const double aspect = entry.contains("aspect") ? number(entry, "aspect") : width / height;
    if (!(aspect > 1e-3 && aspect < 1e3)) throw FieldError("aspect", "is not possible");
    set_lens(camera, number(entry, "fov"), std::max(1, static_cast<int>(std::lround(height * aspect))),
             static_cast<int>(height));
    return camera;
  });
}

std::optional<double> nerfstudio_path_rate(const std::filesystem::path& file) {
  const json object = read_json_object(file);
  const auto rate = object.find("fps");
  if (rate == object.end() || !rate->is_number() || !(rate->get<double>() > 0)) return std::nullopt;
  return rate->get<double>();
}

std::string nerfstudio_path_text(const std::vector<PhotoCamera>& cameras) {
  constexpr double frames_per_second = 24;
  json file = {{"camera_type", "perspective"},
               {"render_height", cameras.empty() ? 0 : cameras.front().height},
               {"render_width", cameras.empty() ? 0 : cameras.front().width},
               {"fps", frames_per_second},
               {"seconds", static_cast<double>(cameras.size()) / frames_per_second},
               {"is_cycle", false},
               {"keyframes", json::array()},
               {"camera_path", json::array()}};
  for (const PhotoCamera& camera : cameras) {
    check(camera);
    json matrix = json::array();
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) matrix.push_back(camera.axes(row, column));
      matrix.push_back(camera.eye[row]);
    }
    for (const double last : {0.0, 0.0, 0.0, 1.0}) matrix.push_back(last);
    file["camera_path"].push_back({{"camera_to_world", std::move(matrix)},
                                   {"fov", 2 * std::atan(camera.height / (2 * camera.focal.y())) / radians_per_degree},
                                   {"aspect", static_cast<double>(camera.width) / camera.height}});
  }
  return marked_camera_text(std::move(file));
}

std::vector<PhotoCamera> read_ngp_path(const std::filesystem::path& file, std::vector<std::string>& notes) {
  const json object = read_json_object(file);
  constexpr double scale = 0.33, offset = 0.5;
  notes.emplace_back("the path is assumed to belong to a capture with instant-ngp's usual scale 0.33 and offset 0.5");
  notes.emplace_back("the file does not state a picture size; 1080 rows and the aspect 16 : 9 are assumed");
  // (x, y, z) of the capture is (y, z, x) in the cube.
  const auto uncycled = [](const Vec3& v) { return Vec3(v.z(), v.x(), v.y()); };
  return read_entries(file, object, "path", [&](const json& entry) {
    const std::vector<double> q = numbers(entry, "R", 4), at = numbers(entry, "T", 3);
    const Eigen::Quaterniond rotation(q[3], q[0], q[1], q[2]);
    if (!(rotation.norm() > 0) || !std::isfinite(rotation.norm())) throw FieldError("R", "is zero or not finite");
    const Mat3 to_cube = rotation.normalized().toRotationMatrix();
    PhotoCamera camera;
    // The cube's cameras have the axes right, down and forward.
    camera.axes << uncycled(to_cube.col(0)), uncycled(-to_cube.col(1)), uncycled(-to_cube.col(2));
    camera.eye = uncycled((Vec3(at[0], at[1], at[2]) - Vec3::Constant(offset)) / scale);
    set_lens(camera, number(entry, "fov"), 1920, 1080);
    return camera;
  });
}

}  // namespace rebake
