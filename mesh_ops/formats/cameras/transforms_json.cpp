#include "mesh_ops/formats/cameras/transforms_json.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/cameras/camera_formats.h"
#include "mesh_ops/formats/cameras/camera_mark.h"
#include "mesh_ops/formats/cameras/json_file.h"
#include "mesh_ops/formats/cameras/photographs.h"
#include "mesh_ops/formats/images/picture_codecs.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

using nlohmann::json;

constexpr std::array radial_keys{"k1", "k2", "k3", "k4"};

// A field of a frame, else that of the whole file; null if neither has it.
struct FrameFields {
  const json& frame;
  const json& file;

  const json* find(const char* key) const {
    if (const auto own = frame.find(key); own != frame.end() && !own->is_null()) return &*own;
    if (const auto common = file.find(key); common != file.end() && !common->is_null()) return &*common;
    return nullptr;
  }
  bool has(const char* key) const { return find(key) != nullptr; }
  double number(const char* key, double missing) const {
    const json* const value = find(key);
    if (value == nullptr) return missing;
    if (!value->is_number()) throw FieldError(key, "must be a number");
    return value->get<double>();
  }
  std::string text(const char* key) const {
    const json* const value = find(key);
    if (value == nullptr) return "";
    if (!value->is_string()) throw FieldError(key, "must be a text");
    return value->get<std::string>();
  }
};

void read_pose(const json& frame, PhotoCamera& camera) {
  constexpr const char* key = "transform_matrix";
  const auto found = frame.find(key);
  if (found == frame.end()) throw FieldError(key, "is missing");
  const json& rows = *found;
  if (!rows.is_array() || (rows.size() != 3 && rows.size() != 4)) throw FieldError(key, "must have 3 or 4 rows");
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  for (std::size_t row = 0; row < rows.size(); ++row) {
    if (!rows[row].is_array() || rows[row].size() != 4) throw FieldError(key, "must have rows of 4 numbers");
    for (std::size_t column = 0; column < 4; ++column) {
      if (!rows[row][column].is_number()) throw FieldError(key, "must contain numbers only");
      matrix(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column)) = rows[row][column].get<double>();
    }
  }
  if (matrix.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) throw FieldError(key, "must have the last row 0 0 0 1");
  camera.axes = rotation_of_pose(matrix.topLeftCorner<3, 3>(), key);
  camera.eye = matrix.topRightCorner<3, 1>();
}

struct PictureSize {
  int width = 0, height = 0;
};

// The size of the first photograph that can be read; 0 if there is none.
PictureSize size_of_photographs(const fs::path& folder, const json& frames) {
  for (const json& frame : frames) {
    const auto path = frame.is_object() ? frame.find("file_path") : frame.end();
    if (!frame.is_object() || path == frame.end() || !path->is_string()) continue;
    const fs::path picture = photograph_at(folder, path->get<std::string>());
    if (picture.empty()) continue;
    try {
      const auto reader = open_picture(picture);
      return {reader->layout().width, reader->layout().height};
    } catch (const FileError&) {
      // A placeholder or a damaged file: another one will do.
    }
  }
  return {};
}

int whole(double value, const char* key) {
  if (!(value >= 1 && value <= 1 << 20) || value != std::floor(value))
    throw FieldError(key, "must be a whole number of pixels");
  return static_cast<int>(value);
}

void read_intrinsics(const FrameFields& fields, PictureSize fallback, PhotoCamera& camera) {
  camera.width = fields.has("w") ? whole(fields.number("w", 0), "w") : fallback.width;
  camera.height = fields.has("h") ? whole(fields.number("h", 0), "h") : fallback.height;
  const auto focal_of = [&](const char* focal, const char* angle, int size) {
    if (fields.has(focal)) return fields.number(focal, 0);
    return fields.has(angle) ? size / (2 * std::tan(fields.number(angle, 0) / 2)) : 0;
  };
  camera.focal.x() = focal_of("fl_x", "camera_angle_x", camera.width);
  camera.focal.y() = focal_of("fl_y", "camera_angle_y", camera.height);
  if (camera.focal.x() == 0) camera.focal.x() = camera.focal.y();
  if (camera.focal.y() == 0) camera.focal.y() = camera.focal.x();
  if (camera.focal.x() == 0) throw FieldError("camera_angle_x", "is missing, and so is fl_x");
  camera.center = {fields.number("cx", camera.width / 2.0), fields.number("cy", camera.height / 2.0)};
  const std::string model = fields.text("camera_model");
  const json* const fisheye = fields.find("is_fisheye");
  camera.distortion.fisheye = model == "OPENCV_FISHEYE" || (fisheye != nullptr && *fisheye == true);
  if (model == "EQUIRECTANGULAR") throw FieldError("camera_model", "EQUIRECTANGULAR is not a perspective camera");
  for (std::size_t k = 0; k < radial_keys.size(); ++k) camera.distortion.radial[k] = fields.number(radial_keys[k], 0);
  camera.distortion.tangential = {fields.number("p1", 0), fields.number("p2", 0)};
}

PhotoCamera read_frame(const FrameFields& fields, PictureSize fallback) {
  if (!fields.frame.is_object()) throw FieldError("frames", "must contain objects");
  PhotoCamera camera;
  camera.name = fields.text("file_path");
  if (camera.name.starts_with("./")) camera.name.erase(0, 2);
  camera.mask = fields.text("mask_path");
  read_pose(fields.frame, camera);
  read_intrinsics(fields, fallback, camera);
  check(camera);
  return camera;
}

json matrix_json(const PhotoCamera& camera) {
  json rows = json::array();
  for (int row = 0; row < 3; ++row)
    rows.push_back({camera.axes(row, 0), camera.axes(row, 1), camera.axes(row, 2), camera.eye[row]});
  rows.push_back({0.0, 0.0, 0.0, 1.0});
  return rows;
}

void write_intrinsics(const PhotoCamera& camera, json& object) {
  object["w"] = camera.width;
  object["h"] = camera.height;
  object["fl_x"] = camera.focal.x();
  object["fl_y"] = camera.focal.y();
  object["cx"] = camera.center.x();
  object["cy"] = camera.center.y();
  object["camera_model"] = camera.distortion.fisheye ? "OPENCV_FISHEYE" : "OPENCV";
  if (camera.distortion.divisor != decltype(camera.distortion.divisor){})
    throw FieldError("camera", camera.name + " has a rational lens distortion, which transforms.json cannot hold");
  for (std::size_t k = 0; k < radial_keys.size(); ++k)
    if (camera.distortion.radial[k] != 0) object[radial_keys[k]] = camera.distortion.radial[k];
  if (camera.distortion.tangential[0] != 0) object["p1"] = camera.distortion.tangential[0];
  if (camera.distortion.tangential[1] != 0) object["p2"] = camera.distortion.tangential[1];
}

bool same_intrinsics(const PhotoCamera& a, const PhotoCamera& b) {
  return a.width == b.width && a.height == b.height && a.focal == b.focal && a.center == b.center &&
         a.distortion == b.distortion;
}

}  // namespace

std::vector<PhotoCamera> read_transforms(const fs::path& file, std::vector<std::string>& notes) {
  const json read = read_json_object(file);
  const auto frames = read.find("frames");
  if (frames == read.end() || !frames->is_array()) throw FileError(file, "has no list \"frames\"");
  if (frames->empty()) throw FileError(file, "has no frames");
  std::vector<PhotoCamera> cameras;
  std::size_t number = 0;
  try {
    PictureSize size;
    if (!read.contains("w") || !read.contains("h")) {
      const bool stated = std::all_of(frames->begin(), frames->end(), [](const json& frame) {
        return frame.is_object() && frame.contains("w") && frame.contains("h");
      });
      if (!stated) {
        size = size_of_photographs(file.parent_path(), *frames);
        if (size.width == 0) size = {800, 800};
        notes.push_back(fmt::format("the file does not state the size of its pictures; {} × {} pixels are assumed",
                                    size.width, size.height));
      }
    }
    for (const json& frame : *frames) {
      cameras.push_back(read_frame({frame, read}, size));
      ++number;
    }
  } catch (const FieldError& error) {
    throw FileError(file, fmt::format("frame {}: {}", number, error.what()));
  }
  if (read.contains("applied_transform"))
    notes.emplace_back("the cameras are in the frame after the file's applied_transform");
  return cameras;
}

std::string transforms_text(const std::vector<PhotoCamera>& cameras) {
  json file = json::object();
  const bool common = std::all_of(cameras.begin(), cameras.end(),
                                  [&](const PhotoCamera& one) { return same_intrinsics(one, cameras.front()); });
  if (common && !cameras.empty()) write_intrinsics(cameras.front(), file);
  file["frames"] = json::array();
  for (const PhotoCamera& camera : cameras) {
    check(camera);
    json frame = {{"file_path", camera.name}, {"transform_matrix", matrix_json(camera)}};
    if (!common) write_intrinsics(camera, frame);
    if (!camera.mask.empty()) frame["mask_path"] = camera.mask.string();
    file["frames"].push_back(std::move(frame));
  }
  return marked_camera_text(std::move(file));
}

}  // namespace rebake
