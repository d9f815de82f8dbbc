#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Adds the content of a MobileNeRF folder or Rebake scene as a new root.
struct Import {
  static constexpr const char* op = "import";
  static constexpr bool makes_nodes = true;
  std::string path;        ///< folder to read
  std::string as;          ///< name of the new node; empty: the folder's name
  Axes axes = Axes::y_up;  ///< orientation of a MobileNeRF folder; scenes contain their own
  std::string content;     ///< expected hash of the folder's files; empty: any
  bool ground = false;     ///< moves the scene's ground to the lowest point of all visible objects
};
template <>
const EditType& edit_type<Import>();

Outcome apply(const Scene& scene, const Import& edit, const Progress& progress = {});
/// Title of a step: see EditType::title.
std::string whole_title(const Import& edit);

}  // namespace rebake
