#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Shows a hidden node; it stays invisible inside a hidden group.
struct Show {
  static constexpr const char* op = "show";
  static constexpr const char* done = "Showed";
  NodeRef node;
};
template <>
const EditType& edit_type<Show>();

Scene apply(const Scene& scene, const Show& edit);

}  // namespace rebake
