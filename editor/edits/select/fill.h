#pragma once

#include "editor/edits/select/selecting.h"

namespace rebake {

/// Adds the islands inside the selection: unselected triangles, joined through edges, that border it.
struct Fill {
  static constexpr const char* op = "fill";
  static constexpr bool selects = true;
  std::optional<NodeRef> node;
  int at_most = 1000;
  WeldingField welding;
};
template <>
const EditType& edit_type<Fill>();

Scene apply(const Scene& scene, const Fill& edit);

}  // namespace rebake
