#pragma once

#include "editor/edits/select/selecting.h"

namespace rebake {

/// Selects the connected components of opaque surface that contain the triangle nearest to a point, or any selected
/// triangle. Triangles are connected if they share an edge with opaque texels on both sides.
struct SelectConnected {
  static constexpr const char* op = "select_connected";
  static constexpr bool selects = true;
  static constexpr bool needs_selection = true;
  std::optional<NodeRef> node;  ///< nothing: all visible, unlocked objects
  std::optional<Vec3> point;    ///< in world space; nothing: starts from the present selection
  ConnectivityFields joining;
  SelectMode mode = SelectMode::set;
};
template <>
const EditType& edit_type<SelectConnected>();

Scene apply(const Scene& scene, const SelectConnected& edit);

}  // namespace rebake
