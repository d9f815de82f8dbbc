#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Renames a node.
struct Rename {
  static constexpr const char* op = "rename";
  NodeRef node;
  std::string name;  ///< new, unique name
};
template <>
const EditType& edit_type<Rename>();

Scene apply(const Scene& scene, const Rename& edit);
/// Title of a step: see EditType::title.
std::string whole_title(const Rename& edit);

}  // namespace rebake
