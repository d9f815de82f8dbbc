#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Scales, rotates and translates, in this order, a node or its selected triangles about a pivot in world space.
struct Transform {
  static constexpr const char* op = "transform";
  static constexpr AdjustableField adjustable[] = {{"translate", "Move", AdjustableField::Kind::point},
                                                   {"rotate", "Rotate", AdjustableField::Kind::rotation},
                                                   {"scale", "Scale", AdjustableField::Kind::factors}};
  NodeRef node;
  bool selection = false;  ///< only the selected triangles
  Vec3 translate{0, 0, 0};
  Rotation rotate;
  Scale scale;
  Rotation scale_axes;        ///< rotation from the world axes to the axes of the scale
  std::optional<Vec3> pivot;  ///< fixed point of rotation and scale; nothing: centre of the world box
};
template <>
const EditType& edit_type<Transform>();

Scene apply(const Scene& scene, const Transform& edit);
/// The past tense for titles of steps: see EditType::done.
std::string done_words(const Transform& edit);
/// See EditType::change_title.
std::string change_title(const Transform& edit, const SceneChange& change, const Transform* replaced);

}  // namespace rebake
