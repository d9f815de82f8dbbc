#pragma once

#include "editor/edits/select/selecting.h"

namespace rebake {

/// Selects floaters: small connected components of opaque surface, see SelectConnected.
struct SelectFloaters {
  static constexpr const char* op = "select_floaters";
  static constexpr bool selects = true;
  std::optional<NodeRef> node;  ///< nothing: all visible, unlocked objects
  int at_most = 100;            ///< largest component to select, in triangles
  ConnectivityFields joining;
  SelectMode mode = SelectMode::set;
};
template <>
const EditType& edit_type<SelectFloaters>();

Scene apply(const Scene& scene, const SelectFloaters& edit);

}  // namespace rebake
