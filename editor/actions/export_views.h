#pragma once

#include "editor/actions/action.h"
#include "editor/actions/session.h"
#include "editor/fields/values.h"
#include "mesh_ops/scene/photo_camera.h"

namespace rebake {

/// Writes stored views as a camera file.
struct ExportViewsAction {
  static constexpr const char* op = "export_views";
  std::string out;  ///< file to write
  CameraFormatName format{"transforms"};
  std::vector<std::string> views;  ///< names of stored views; empty: all
  int width = 800;                 ///< size of the pictures, pixels
  int height = 800;                ///< pixels
  std::optional<WorldUp> world;    ///< the axis that points up in the file; nothing: as usual for the format
};
template <>
const ActionType& action_type<ExportViewsAction>();

void run(Session& session, const ExportViewsAction& action);

}  // namespace rebake
