#pragma once

#include "editor/actions/action.h"
#include "editor/actions/session.h"

namespace rebake {

/// Publishes the scene as a web page.
struct PublishAction {
  static constexpr const char* op = "publish";
  std::string out;                 ///< folder; a file if `single_file`
  std::string title;               ///< empty: the name of the output
  std::string view;                ///< stored view at the start; empty: `camera`
  std::optional<Camera> camera;    ///< at the start; nothing: one that frames the scene
  std::vector<std::string> views;  ///< stored views to offer; empty: all
  bool single_file = false;
  std::string before;        ///< scene before the edits: a folder, scene or project; empty: none
  bool poster = false;       ///< a picture that shows until the scene is loaded, and in links
  bool transparent = false;  ///< no background

  /// `before`, and the sources of a project.
  static std::vector<std::filesystem::path> input_files(const nlohmann::json& object);
};
template <>
const ActionType& action_type<PublishAction>();
template <>
PublishAction read_action<PublishAction>(const nlohmann::json& object, const Scene& scene);

/// Throws FieldError for invalid fields, EditError for a scene of no triangles, FileError if the output cannot be
/// written or is no earlier page.
void run(Session& session, const PublishAction& action);

}  // namespace rebake
