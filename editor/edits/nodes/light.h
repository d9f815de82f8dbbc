#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Sets the scene's light: the effects that follow edits (shadows, highlights), and the light source.
struct LightEdit {
  static constexpr const char* op = "light";
  /// auto, none, or any of: self (shadows of an object on itself), cast (between objects), removed (shadows of removed
  /// objects), highlights (needs self), match (lights all objects alike).
  std::vector<std::string> effects{"auto"};
  std::string source;            ///< estimated, uniform, sky or picture; empty: see light_source()
  double sun_degrees = 5;        ///< angular radius of the sun
  double budget = 1;             ///< maximum summed change of display colours by omitted effects, in 1/255
  std::string picture, content;  ///< environment map: file, and its expected hash (empty: any)
  double picture_degrees = 0;    ///< rotation of the environment map about the up axis
  SceneLight light;              ///< all other settings

  static constexpr const char* source_field = "picture";
  /// With the effects "none", the picture is not read.
  EditSource input() const {
    return effects == std::vector<std::string>{"none"} ? EditSource{} : EditSource{picture, content};
  }
  void set_input(const EditSource& read) { picture = read.path.string(), content = read.content; }

  /// The source; by default picture if there is one, else estimated.
  std::string light_source() const { return !source.empty() ? source : picture.empty() ? "estimated" : "picture"; }
};
template <>
const EditType& edit_type<LightEdit>();

Scene apply(const Scene& scene, const LightEdit& edit);

/// The edit that sets a scene's light to `light`.
LightEdit light_edit(const SceneLight& light, const Scene& scene);
/// Title of a step: see EditType::title.
std::string whole_title(const LightEdit& edit);

}  // namespace rebake
