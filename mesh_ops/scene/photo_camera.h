#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mesh_ops/scene/camera.h"

namespace rebake {

/// Lens distortion of a photograph, on coordinates of the image plane at depth 1 (x right, y down).
struct LensDistortion {
  bool fisheye = false;             ///< equidistant model of OpenCV: powers of the angle instead of the radius r
  std::array<double, 4> radial{};   ///< 1 + k1 r² + k2 r⁴ + k3 r⁶ + k4 r⁸
  std::array<double, 3> divisor{};  ///< divided by 1 + d1 r² + d2 r⁴ + d3 r⁶ (k4 … k6 of OpenCV); not for fisheye
  std::array<double, 2> tangential{};  ///< p1, p2

  bool operator==(const LensDistortion&) const = default;
  bool none() const { return *this == LensDistortion{}; }
};

/// Pose and intrinsics of a photograph, as capture tools store them. Lengths of the picture are in pixels.
struct PhotoCamera {
  std::string name;              ///< file name of the photograph; empty if the file states none
  Mat3 axes = Mat3::Identity();  ///< rotation: columns right, up and back in world space
  Vec3 eye = Vec3::Zero();       ///< world space
  int width = 0, height = 0;     ///< size of the picture; 0: unknown
  Vec2 focal{0, 0};              ///< focal lengths in x and y
  Vec2 center{0, 0};             ///< principal point from the upper left corner of the picture
  LensDistortion distortion;
  std::filesystem::path mask;            ///< mask beside the photograph; empty: none
  double near_plane = 0, far_plane = 0;  ///< depths that the file states; 0: none

  bool operator==(const PhotoCamera&) const = default;
};

/// Which axis points up in the world of a file.
enum class WorldUp { y, z };

/// The cameras in Rebake's frame, where y points up: (x, y, z) becomes (x, z, −y) if z points up in the file.
std::vector<PhotoCamera> with_y_up(std::vector<PhotoCamera> cameras, WorldUp up);
/// The inverse of with_y_up().
std::vector<PhotoCamera> from_y_up(std::vector<PhotoCamera> cameras, WorldUp up);

/// The cameras as views. A view looks at the point of its axis that is nearest to where all axes meet. Views have no
/// distortion and a central principal point; appends a note on dropped properties to `notes`.
std::vector<Camera> views_of(const std::vector<PhotoCamera>& cameras, std::vector<std::string>& notes);

/// The camera of a picture of a view; `name`: file name of the picture.
PhotoCamera photo_camera(const Camera& view, const std::string& name, int width, int height);

/// The point of the picture where a world point appears, in pixels from the upper left corner of the picture, with lens
/// distortion (model of OpenCV); may lie outside the picture. Nothing for points behind the camera, and for points so
/// far off the axis that the distortion no longer grows with the angle.
std::optional<Vec2> pixel_of(const PhotoCamera& camera, const Vec3& world);

/// Throws FieldError for a camera without focal length or size, with values that are not finite, or whose axes are not
/// a rotation within 1e-3.
void check(const PhotoCamera& camera);

/// The rotation of a pose whose columns are those of a rotation times a positive scale, as files store it. Throws
/// FieldError for mirrored, sheared and singular ones (tolerance 1e-3).
Mat3 rotation_of_pose(const Mat3& columns, const std::string& field);

}  // namespace rebake
