#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Reads a MobileNeRF folder or a Rebake scene into the scene.
struct Import {
  static constexpr const char* op = "import";
  std::string path;
  std::string as;
  Axes axes = Axes::y_up;
  std::string content;
  bool ground = false;  ///< moves the scene's ground to the lowest point of the imported objects
};
template <>
const EditType& edit_type<Import>();

Outcome apply(const Scene& scene, const Import& edit, const Progress& progress = {});

}  // namespace rebake
