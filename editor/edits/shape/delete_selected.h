#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Removes the selected triangles; a node that loses all goes too.
struct DeleteSelected {
  static constexpr const char* op = "delete";
  std::optional<NodeRef> node;
};
template <>
const EditType& edit_type<DeleteSelected>();

Outcome apply(const Scene& scene, const DeleteSelected& edit);

}  // namespace rebake
