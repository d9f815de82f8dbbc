#pragma once

#include "editor/actions/action.h"
#include "editor/actions/picture_output.h"
#include "editor/actions/session.h"
#include "editor/fields/values.h"

namespace rebake {

/// Renders the scene to a picture file (write_picture).
struct RenderAction {
  static constexpr const char* op = "render";
  std::string out;               ///< file to write
  std::string view;              ///< name of a stored view; empty: `camera`
  std::optional<Camera> camera;  ///< nothing: a camera that frames the scene
  int width = 800;               ///< pixels
  int height = 800;              ///< pixels
  int samples = 4;               ///< samples per pixel: 1, 4 or 16
  PictureContent content;
  std::optional<double> time;      ///< seconds: places and bends by keyframes; nothing: as the scene stands
  std::optional<PixelSize> sheet;  ///< columns and rows of a contact sheet of all stored views
  std::vector<NodeRef> nodes;      ///< only these and their children; empty: all
};
template <>
const ActionType& action_type<RenderAction>();
template <>
RenderAction read_action<RenderAction>(const nlohmann::json& object, const Scene& scene);

void run(Session& session, const RenderAction& action);

}  // namespace rebake
