#include "mesh_ops/formats/cameras/colmap.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <map>
#include <sstream>
#include <utility>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

// Camera models with their parameters in the order of COLMAP's files.
struct Model {
  int id;
  const char* name;
  bool fisheye;
  std::vector<std::string> parameters;
};

const std::vector<Model>& models() {
  static const std::vector<Model> table{
      {0, "SIMPLE_PINHOLE", false, {"f", "cx", "cy"}},
      {1, "PINHOLE", false, {"fx", "fy", "cx", "cy"}},
      {2, "SIMPLE_RADIAL", false, {"f", "cx", "cy", "k1"}},
      {3, "RADIAL", false, {"f", "cx", "cy", "k1", "k2"}},
      {4, "OPENCV", false, {"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2"}},
      {5, "OPENCV_FISHEYE", true, {"fx", "fy", "cx", "cy", "k1", "k2", "k3", "k4"}},
      {6, "FULL_OPENCV", false, {"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"}},
      {8, "SIMPLE_RADIAL_FISHEYE", true, {"f", "cx", "cy", "k1"}},
      {9, "RADIAL_FISHEYE", true, {"f", "cx", "cy", "k1", "k2"}},
  };
  return table;
}

void set_parameter(PhotoCamera& camera, const std::string& name, double value) {
  if (name == "f" || name == "fx") camera.focal.x() = value;
  if (name == "f" || name == "fy") camera.focal.y() = value;
  if (name == "cx") camera.center.x() = value;
  if (name == "cy") camera.center.y() = value;
  const auto number = static_cast<std::size_t>(name.back() - '1');
  const bool divides = !camera.distortion.fisheye && number >= 3;  // k4 … k6 of FULL_OPENCV
  if (name.front() == 'k') (divides ? camera.distortion.divisor[number - 3] : camera.distortion.radial[number]) = value;
  if (name.front() == 'p') camera.distortion.tangential[number] = value;
}

// Intrinsics of one of COLMAP's cameras, which several images share.
PhotoCamera intrinsics(const Model& model, std::uint64_t width, std::uint64_t height,
                       const std::vector<double>& values) {
  if (width == 0 || height == 0 || width > 1 << 20 || height > 1 << 20)
    throw Error(fmt::format("the picture size {} × {} is not possible", width, height));
  PhotoCamera camera;
  camera.width = static_cast<int>(width);
  camera.height = static_cast<int>(height);
  camera.distortion.fisheye = model.fisheye;
  for (std::size_t k = 0; k < values.size(); ++k) set_parameter(camera, model.parameters[k], values[k]);
  return camera;
}

// Rotation (w, x, y, z) and translation from world to camera.
void set_pose(PhotoCamera& camera, const std::array<double, 4>& q, const Vec3& translation) {
  const Eigen::Quaterniond rotation(q[0], q[1], q[2], q[3]);
  const double norm = rotation.norm();
  if (!(norm > 0) || !std::isfinite(norm)) throw Error("the quaternion is zero or not finite");
  const Mat3 to_camera = rotation.normalized().toRotationMatrix();
  camera.eye = -(to_camera.transpose() * translation);
  camera.axes = to_camera.transpose();
  camera.axes.col(1) *= -1;
  camera.axes.col(2) *= -1;
}

using Cameras = std::map<std::uint64_t, PhotoCamera>;

const PhotoCamera& camera_with_id(const Cameras& cameras, std::uint64_t id) {
  const auto found = cameras.find(id);
  if (found == cameras.end()) throw Error(fmt::format("camera {} does not exist", id));
  return found->second;
}

// Lines of a text file without comments; `use` gets each and its number. Errors get file and line.
void for_each_line(const fs::path& file, bool keep_empty, const std::function<void(std::istringstream& line)>& use) {
  std::istringstream text(read_file(file));
  std::size_t number = 0;
  for (std::string line; std::getline(text, line);) {
    ++number;
    if (line.starts_with('#') || (!keep_empty && line.find_first_not_of(" \t\r") == std::string::npos)) continue;
    std::istringstream fields(line);
    try {
      use(fields);
    } catch (const FileError&) {
      throw;
    } catch (const Error& error) {
      throw FileError(file, fmt::format("line {}: {}", number, error.what()));
    }
  }
}

template <class T>
T next(std::istringstream& line, const char* what) {
  T value{};
  if (!(line >> value)) throw Error(fmt::format("{} is missing or not a number", what));
  return value;
}

Cameras read_cameras_text(const fs::path& file) {
  Cameras cameras;
  for_each_line(file, false, [&](std::istringstream& line) {
    const auto id = next<std::uint64_t>(line, "the camera's number");
    std::string name;
    line >> name;
    const auto model =
        std::find_if(models().begin(), models().end(), [&](const Model& one) { return one.name == name; });
    if (model == models().end()) throw Error("the camera model \"" + name + "\" is not supported");
    const auto width = next<std::uint64_t>(line, "the width"), height = next<std::uint64_t>(line, "the height");
    std::vector<double> values;
    for (std::size_t k = 0; k < model->parameters.size(); ++k) values.push_back(next<double>(line, "a parameter"));
    cameras[id] = intrinsics(*model, width, height, values);
  });
  return cameras;
}

std::vector<PhotoCamera> read_images_text(const fs::path& file, const Cameras& cameras) {
  std::vector<PhotoCamera> images;
  bool points = false;  // every second line lists points, and may be empty
  for_each_line(file, true, [&](std::istringstream& line) {
    if (std::exchange(points, !points)) return;
    if (line.str().find_first_not_of(" \t\r") == std::string::npos) {
      points = false;
      return;
    }
    next<std::uint64_t>(line, "the image's number");
    std::array<double, 4> q{};
    for (double& one : q) one = next<double>(line, "the quaternion");
    Vec3 translation;
    for (double& one : translation) one = next<double>(line, "the translation");
    PhotoCamera camera = camera_with_id(cameras, next<std::uint64_t>(line, "the camera's number"));
    set_pose(camera, q, translation);
    std::getline(line >> std::ws, camera.name);
    while (camera.name.ends_with('\r') || camera.name.ends_with(' ')) camera.name.pop_back();
    images.push_back(std::move(camera));
  });
  return images;
}

// Reads little-endian values from a binary file.
class BinaryReader {
 public:
  explicit BinaryReader(const std::string& bytes) : bytes_(bytes) {}
  template <class T>
  T get() {
    static_assert(std::endian::native == std::endian::little);
    T value;
    std::memcpy(&value, take(sizeof(T)), sizeof(T));
    return value;
  }
  std::string text() {
    const std::size_t end = bytes_.find('\0', at_);
    if (end == std::string::npos) throw Error("is truncated");
    return {take(end + 1 - at_)};
  }
  void skip(std::uint64_t count, std::uint64_t size) {
    if (count > (bytes_.size() - at_) / size) throw Error("is truncated");
    at_ += count * size;
  }
  bool at_end() const { return at_ == bytes_.size(); }

 private:
  const char* take(std::size_t count) {
    if (count > bytes_.size() - at_) throw Error("is truncated");
    const char* const from = bytes_.data() + at_;
    at_ += count;
    return from;
  }
  const std::string& bytes_;
  std::size_t at_ = 0;
};

Cameras read_cameras_binary(BinaryReader& file) {
  Cameras cameras;
  for (auto count = file.get<std::uint64_t>(); count > 0; --count) {
    const auto id = file.get<std::uint32_t>();
    const auto number = file.get<std::int32_t>();
    const auto model =
        std::find_if(models().begin(), models().end(), [&](const Model& one) { return one.id == number; });
    if (model == models().end()) throw Error(fmt::format("camera model {} is not supported", number));
    const auto width = file.get<std::uint64_t>(), height = file.get<std::uint64_t>();
    std::vector<double> values;
    for (std::size_t k = 0; k < model->parameters.size(); ++k) values.push_back(file.get<double>());
    cameras[id] = intrinsics(*model, width, height, values);
  }
  return cameras;
}

std::vector<PhotoCamera> read_images_binary(BinaryReader& file, const Cameras& cameras) {
  std::vector<PhotoCamera> images;
  for (auto count = file.get<std::uint64_t>(); count > 0; --count) {
    file.get<std::uint32_t>();  // number of the image
    std::array<double, 4> q{};
    for (double& one : q) one = file.get<double>();
    Vec3 translation;
    for (double& one : translation) one = file.get<double>();
    PhotoCamera camera = camera_with_id(cameras, file.get<std::uint32_t>());
    set_pose(camera, q, translation);
    camera.name = file.text();
    constexpr std::uint64_t point_bytes = 24;
    file.skip(file.get<std::uint64_t>(), point_bytes);
    images.push_back(std::move(camera));
  }
  return images;
}

// Calls `read` with the whole file. Errors get the file's name.
template <class Read>
auto read_binary(const fs::path& path, const Read& read) {
  const std::string bytes = read_file(path);
  try {
    BinaryReader file(bytes);
    auto result = read(file);
    if (!file.at_end()) throw Error("has bytes after its last entry");
    return result;
  } catch (const FileError&) {
    throw;
  } catch (const Error& error) {
    throw FileError(path, error.what());
  }
}

bool has_files(const fs::path& folder, const char* extension) {
  std::error_code error;
  return fs::is_regular_file(folder / (std::string("cameras") + extension), error) &&
         fs::is_regular_file(folder / (std::string("images") + extension), error);
}

}  // namespace

fs::path colmap_folder(const fs::path& path) {
  for (const fs::path& folder : {path, path / "sparse" / "0", path / "sparse"})
    if (has_files(folder, ".bin") || has_files(folder, ".txt")) return folder;
  return {};
}

std::vector<fs::path> colmap_files(const fs::path& path) {
  const fs::path folder = colmap_folder(path);
  const std::string extension = has_files(folder, ".bin") ? ".bin" : ".txt";
  return {folder / ("cameras" + extension), folder / ("images" + extension)};
}

std::vector<PhotoCamera> read_colmap(const fs::path& path, std::vector<std::string>& notes) {
  const std::vector<fs::path> files = colmap_files(path);
  std::vector<PhotoCamera> images;
  if (files.front().extension() == ".bin") {
    const Cameras cameras = read_binary(files[0], read_cameras_binary);
    images = read_binary(files[1], [&](BinaryReader& file) { return read_images_binary(file, cameras); });
  } else {
    images = read_images_text(files[1], read_cameras_text(files[0]));
  }
  if (images.empty()) throw FileError(files[1], "contains no images");
  for (const PhotoCamera& image : images) {
    try {
      check(image);
    } catch (const FieldError& error) {
      throw FileError(files[1], error.what());
    }
  }
  std::sort(images.begin(), images.end(), [](const PhotoCamera& a, const PhotoCamera& b) { return a.name < b.name; });
  if (fs::absolute(path).lexically_normal() != fs::absolute(files[0]).parent_path().lexically_normal())
    notes.push_back("the model in " + files[0].parent_path().string() + " was read");
  return images;
}

}  // namespace rebake
