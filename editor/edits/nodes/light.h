#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Says what light does in the scene: which effects follow its edits, and where the light comes from.
struct LightEdit {
  static constexpr const char* op = "light";
  std::vector<std::string> effects{"auto"};
  std::string source;  ///< empty: a picture where one is named, else estimated
  double sun_degrees = 5;
  double budget = 1;  ///< of 255
  std::string picture, content;
  double picture_degrees = 0;
  SceneLight light;  ///< the rest

  /// What `source` means.
  std::string light_source() const { return !source.empty() ? source : picture.empty() ? "estimated" : "picture"; }
};
template <>
const EditType& edit_type<LightEdit>();

Scene apply(const Scene& scene, const LightEdit& edit);

/// The edit that makes a scene's light this.
LightEdit light_edit(const SceneLight& light);

}  // namespace rebake
