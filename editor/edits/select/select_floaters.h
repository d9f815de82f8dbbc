#pragma once

#include "editor/edits/select/selecting.h"

namespace rebake {

/// Selects small parts that hang together with nothing else, across opaque texels; look at the count, then delete.
struct SelectFloaters {
  static constexpr const char* op = "select_floaters";
  static constexpr bool selects = true;
  std::optional<NodeRef> node;
  int at_most = 100;
  JoiningFields joining;
  SelectMode mode = SelectMode::set;
};
template <>
const EditType& edit_type<SelectFloaters>();

Scene apply(const Scene& scene, const SelectFloaters& edit);

}  // namespace rebake
