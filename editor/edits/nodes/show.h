#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Makes a node visible again.
struct Show {
  static constexpr const char* op = "show";
  NodeRef node;
};
template <>
const EditType& edit_type<Show>();

Scene apply(const Scene& scene, const Show& edit);

}  // namespace rebake
