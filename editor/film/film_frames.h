#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mesh_ops/scene/scene.h"

namespace rebake {

/// A picture of a film: time of the scene's keyframes, and camera.
struct FilmFrame {
  double seconds = 0;
  Camera camera;
};

/// Whether a film's path is a camera file, not one of the words keys, views and turntable.
bool is_camera_file(const std::string& path);

/// Where the camera of a film goes, and for how long.
struct FilmPath {
  /// keys: the camera's keyframes, or standing still; views: through all stored views in natural order; turntable: once
  /// around `start`; otherwise a camera file.
  std::string path = "keys";
  std::optional<double> fps{};      ///< pictures per second; nothing: as the file states, else 25
  std::optional<double> seconds{};  ///< nothing: up to the last keyframe, 2 s from view to view, 8 s around, 1 s per
                                    ///< camera of a file
  bool loop = false;                ///< returns to the first view, and ends just before it
  Camera start{};                   ///< camera without keyframes, and at the start of a turntable
  Vec3 up{0, 1, 0};                 ///< axis of a turntable, unit
};

/// The frames of a film, all planes of cameras as given. Appends assumptions to `notes`, and sets `fps` to the rate.
/// A camera path of nerfstudio gives one camera per picture; the cameras of other files are keyframes. Throws
/// FieldError, FileError.
std::vector<FilmFrame> film_frames(const Scene& scene, const FilmPath& path, double& fps,
                                   std::vector<std::string>& notes);

/// Cameras at equal times on a smooth way through at least one camera (value_at()).
std::vector<Camera> cameras_through(const std::vector<Camera>& views, std::size_t count);
/// The camera turned about the target by `count` equal angles of a full circle.
std::vector<Camera> cameras_around(const Camera& start, const Vec3& up, std::size_t count);

}  // namespace rebake
