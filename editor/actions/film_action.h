#pragma once

#include "editor/actions/action.h"
#include "editor/actions/picture_output.h"
#include "editor/actions/session.h"
#include "editor/fields/values.h"

namespace rebake {

/// Renders a film: numbered pictures in a folder, or a video that ffmpeg encodes. The scene moves by its keyframes
/// (scene_at()). A film that was interrupted goes on with the pictures that are missing.
struct FilmAction {
  static constexpr const char* op = "film";
  std::string out;                ///< folder, or a .mp4 or .webm file
  std::string path = "keys";      ///< see FilmPath
  std::string view;               ///< start without keyframes of the camera: name of a stored view; empty: `camera`
  std::optional<Camera> camera;   ///< nothing: a camera that frames the scene
  std::optional<double> fps;      ///< pictures per second
  std::optional<double> seconds;  ///< length
  bool loop = false;
  int width = 800;   ///< pixels
  int height = 800;  ///< pixels
  int samples = 4;   ///< samples per pixel: 1, 4 or 16
  PictureContent content;
  std::string codec;            ///< encoder of ffmpeg; empty: by the file's name
  std::string picture = "png";  ///< format of the pictures in a folder
  std::vector<NodeRef> nodes;   ///< only these and their children; empty: all

  /// The files of a camera path.
  static std::vector<std::filesystem::path> input_files(const nlohmann::json& object);
};
template <>
const ActionType& action_type<FilmAction>();
template <>
FilmAction read_action<FilmAction>(const nlohmann::json& object, const Scene& scene);

void run(Session& session, const FilmAction& action);

}  // namespace rebake
