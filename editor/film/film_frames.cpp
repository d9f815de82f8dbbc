#include "editor/film/film_frames.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "editor/edits/stored_view.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/cameras/camera_formats.h"
#include "mesh_ops/formats/cameras/camera_path_json.h"
#include "mesh_ops/motion/scene_at.h"

namespace rebake {

namespace {

constexpr double usual_fps = 25, seconds_per_view = 2, seconds_around = 8, seconds_per_camera = 1;
constexpr double most_frames = 1e6;

Keyframes<Camera> keys_through(const std::vector<Camera>& views, double seconds) {
  Keyframes<Camera> keys;
  for (std::size_t k = 0; k < views.size(); ++k)
    set_key(keys, {views.size() < 2 ? 0 : seconds * static_cast<double>(k) / static_cast<double>(views.size() - 1),
                   views[k], Interpolation::smooth});
  return keys;
}

// Number of pictures in `seconds`; both ends are shown, unless the film repeats.
std::size_t frame_count(double seconds, double fps, bool loop) {
  const double steps = std::floor(seconds * fps + 1e-6);
  if (!(steps < most_frames))
    throw FieldError("seconds", fmt::format("makes more than {:.0f} pictures; shorten the film", most_frames));
  return std::max<std::size_t>(1, static_cast<std::size_t>(steps) + (loop ? 0 : 1));
}

std::vector<FilmFrame> frames_of(const Keyframes<Camera>& keys, std::size_t count, double fps) {
  std::vector<FilmFrame> frames;
  for (std::size_t k = 0; k < count; ++k) {
    const double seconds = static_cast<double>(k) / fps;
    frames.push_back({seconds, value_at(keys, seconds)});
  }
  return frames;
}

void check_rate(double fps) {
  if (!(fps > 0 && fps <= 1000)) throw FieldError("fps", "must lie between 0 and 1000 pictures per second");
}

// The way through cameras of a file.
std::vector<FilmFrame> frames_of_file(const FilmPath& path, double& fps, std::vector<std::string>& notes) {
  const CameraFormat& format = camera_format_for(path.path, "");
  const std::vector<PhotoCamera> photographs = read_cameras(path.path, format.name, std::nullopt, notes);
  if (const PhotoCamera& first = photographs.front(); first.width > 0)
    notes.push_back(
        fmt::format("the file's pictures have {}×{} pixels; those of the film have the size that is asked for",
                    first.width, first.height));
  const std::vector<Camera> cameras = views_of(photographs, notes);
  if (format.name == std::string("nerfstudio_path")) {
    fps = path.fps.value_or(nerfstudio_path_rate(path.path).value_or(usual_fps));
    check_rate(fps);
    if (path.seconds || path.loop)
      throw FieldError(path.seconds ? "seconds" : "loop",
                       "does not apply: the file gives a camera for every picture; change fps instead");
    std::vector<FilmFrame> frames;
    for (std::size_t k = 0; k < cameras.size(); ++k) frames.push_back({static_cast<double>(k) / fps, cameras[k]});
    return frames;
  }
  std::vector<Camera> views = cameras;
  if (path.loop) views.push_back(views.front());
  const double seconds = path.seconds.value_or(seconds_per_camera * static_cast<double>(views.size() - 1));
  return frames_of(keys_through(views, seconds), frame_count(seconds, fps, path.loop), fps);
}

}  // namespace

bool is_camera_file(const std::string& path) { return path != "keys" && path != "views" && path != "turntable"; }

std::vector<Camera> cameras_through(const std::vector<Camera>& views, std::size_t count) {
  const Keyframes<Camera> keys = keys_through(views, 1);
  std::vector<Camera> cameras;
  for (std::size_t k = 0; k < count; ++k)
    cameras.push_back(value_at(keys, count < 2 ? 0 : static_cast<double>(k) / static_cast<double>(count - 1)));
  return cameras;
}

std::vector<Camera> cameras_around(const Camera& start, const Vec3& up, std::size_t count) {
  std::vector<Camera> cameras;
  for (std::size_t k = 0; k < count; ++k) {
    const Eigen::AngleAxisd turn(2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(count), up);
    Camera camera = start;
    camera.eye = start.target + turn * (start.eye - start.target);
    camera.up = turn * start.up;
    cameras.push_back(k == 0 ? start : camera);
  }
  return cameras;
}

std::vector<FilmFrame> film_frames(const Scene& scene, const FilmPath& path, double& fps,
                                   std::vector<std::string>& notes) {
  fps = path.fps.value_or(usual_fps);
  check_rate(fps);
  if (path.seconds && !(*path.seconds > 0 && *path.seconds <= 1e6))
    throw FieldError("seconds", "must lie between 0 and 1000000");
  if (path.path == "keys") {
    if (!has_keyframes(scene))
      throw FieldError("path",
                       "the scene has no keyframes; set them with the edit key, or choose views, turntable or a "
                       "camera file");
    Keyframes<Camera> keys = scene.camera_keys;
    if (keys.empty()) keys.push_back({0, path.start, Interpolation::smooth});
    return frames_of(keys, frame_count(path.seconds.value_or(duration(scene)), fps, path.loop), fps);
  }
  if (path.path == "views") {
    std::vector<Camera> views;
    for (const std::string& name : view_names(scene)) views.push_back(scene.views.at(name));
    if (views.size() < 2)
      throw FieldError("path", "needs at least two stored views; store another one with the edit view");
    if (path.loop) views.push_back(views.front());
    const double seconds = path.seconds.value_or(seconds_per_view * static_cast<double>(views.size() - 1));
    return frames_of(keys_through(views, seconds), frame_count(seconds, fps, path.loop), fps);
  }
  if (path.path == "turntable") {
    const std::size_t count = frame_count(path.seconds.value_or(seconds_around), fps, true);
    std::vector<FilmFrame> frames;
    for (const Camera& camera : cameras_around(path.start, path.up, count))
      frames.push_back({static_cast<double>(frames.size()) / fps, camera});
    return frames;
  }
  return frames_of_file(path, fps, notes);
}

}  // namespace rebake
