#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Deletes the selected triangles and closes the holes that they leave with new ones, which continue shape and
/// features.
struct DeleteAndFill {
  static constexpr const char* op = "delete_and_fill";
  static constexpr bool needs_selection = true;
  std::optional<NodeRef> node;  ///< nothing: all visible, unlocked objects
};
template <>
const EditType& edit_type<DeleteAndFill>();

Outcome apply(const Scene& scene, const DeleteAndFill& edit, const Progress& progress);
/// The past tense for titles of steps: see EditType::done.
std::string done_words(const DeleteAndFill& edit);

}  // namespace rebake
