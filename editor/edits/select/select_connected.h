#pragma once

#include "editor/edits/select/selecting.h"

namespace rebake {

/// Selects the parts that hang together, across opaque texels, with the triangle nearest to a point or with the
/// present selection.
struct SelectConnected {
  static constexpr const char* op = "select_connected";
  static constexpr bool selects = true;
  std::optional<NodeRef> node;
  std::optional<Vec3> point;
  JoiningFields joining;
  SelectMode mode = SelectMode::set;
};
template <>
const EditType& edit_type<SelectConnected>();

Scene apply(const Scene& scene, const SelectConnected& edit);

}  // namespace rebake
