#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Makes the selected triangles of a node a node of its own, after it.
struct Separate {
  static constexpr const char* op = "separate";
  NodeRef node;
  std::string as;
};
template <>
const EditType& edit_type<Separate>();

Scene apply(const Scene& scene, const Separate& edit);

}  // namespace rebake
