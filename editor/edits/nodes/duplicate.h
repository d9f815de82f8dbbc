#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Adds a copy of a node and its children after it; triangles and texels stay shared.
struct Duplicate {
  static constexpr const char* op = "duplicate";
  NodeRef node;
  std::string as;
  Vec3 translate{0, 0, 0};
};
template <>
const EditType& edit_type<Duplicate>();

Scene apply(const Scene& scene, const Duplicate& edit);

}  // namespace rebake
