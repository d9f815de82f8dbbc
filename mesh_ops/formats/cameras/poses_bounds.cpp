#include "mesh_ops/formats/cameras/poses_bounds.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/cameras/npy.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

// Names of the photographs in the folder beside the file, sorted; empty if there is no such folder.
std::vector<std::string> photographs(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error))
    if (at->is_regular_file(error)) names.push_back("images/" + at->path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

PhotoCamera camera_of(const double* row) {
  const auto entry = [&](int i, int j) { return row[i * 5 + j]; };
  const auto column = [&](int j) { return Vec3(entry(0, j), entry(1, j), entry(2, j)); };
  PhotoCamera camera;
  Mat3 columns;
  columns << column(1), -column(0), column(2);
  camera.axes = rotation_of_pose(columns, "pose");
  camera.eye = column(3);
  const Vec3 size = column(4);
  if (!(size.minCoeff() > 0) || !(size.maxCoeff() < 1 << 20))
    throw FieldError("pose", "has a height, width or focal length that is not possible");
  camera.height = static_cast<int>(std::lround(size[0]));
  camera.width = static_cast<int>(std::lround(size[1]));
  camera.focal = {size[2], size[2]};
  camera.center = Vec2(camera.width, camera.height) / 2;
  camera.near_plane = row[15];
  camera.far_plane = row[16];
  check(camera);
  return camera;
}

}  // namespace

std::vector<PhotoCamera> read_poses_bounds(const fs::path& file, std::vector<std::string>& notes) {
  const NpyMatrix matrix = read_npy(file);
  if (matrix.columns != 17 || matrix.rows == 0)
    throw FileError(file, fmt::format("has {} rows of {} numbers; poses_bounds.npy has 17 per photograph", matrix.rows,
                                      matrix.columns));
  const std::vector<std::string> names = photographs(file.parent_path() / "images");
  const bool named = names.size() == matrix.rows;
  if (!names.empty() && !named)
    notes.push_back(
        fmt::format("the folder images has {} files for {} cameras, so the cameras have numbers instead of "
                    "names",
                    names.size(), matrix.rows));
  std::vector<PhotoCamera> cameras;
  for (std::size_t k = 0; k < matrix.rows; ++k) {
    try {
      cameras.push_back(camera_of(&matrix.values[k * matrix.columns]));
    } catch (const FieldError& error) {
      throw FileError(file, fmt::format("row {}: {}", k, error.what()));
    }
    if (named) cameras.back().name = names[k];
  }
  return cameras;
}

}  // namespace rebake
