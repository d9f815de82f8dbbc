#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Lets a node fall against the ground's normal until it stands on a visible surface or on the ground plane. A node
/// that intersects a surface or the ground is lifted out first.
struct Drop {
  static constexpr const char* op = "drop";
  static constexpr const char* done = "Dropped";
  NodeRef node;
  std::optional<double> ground;  ///< y of a level ground plane; nothing: the scene's ground
};
template <>
const EditType& edit_type<Drop>();

Outcome apply(const Scene& scene, const Drop& edit, const Progress& progress = {});

}  // namespace rebake
