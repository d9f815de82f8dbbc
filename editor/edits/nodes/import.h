#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Adds the content of a MobileNeRF folder or Rebake scene as a new root.
struct Import {
  static constexpr const char* op = "import";
  static constexpr bool makes_nodes = true;
  std::string path;        ///< folder to read
  std::string as;          ///< name of the new node; empty: the folder's name
  Axes axes = Axes::y_up;  ///< orientation of a MobileNeRF folder; scenes contain their own
  RareFlag half_direction, direction_first, bgr, no_holes;  ///< as in Dialect
  std::optional<AlphaCode> alpha;                           ///< as in Dialect
  std::optional<int> linear;                                ///< as in Dialect
  std::string content;                                      ///< expected hash of the folder's files; empty: any
  bool ground = false;  ///< moves the scene's ground to the lowest point of all visible objects

  /// Throws FieldError if `linear` is not an odd number from 3 to 9.
  Dialect dialect() const;

  static constexpr const char* source_field = "path";
  EditSource input() const { return {path, content}; }
  void set_input(const EditSource& source) { path = source.path.string(), content = source.content; }
};
template <>
const EditType& edit_type<Import>();

/// Whether a field of the edit tells how the folder is to be read.
bool describes_folder(const FieldInfo& field);

Outcome apply(const Scene& scene, const Import& edit, const Progress& progress = {});
/// Title of a step: see EditType::title.
std::string whole_title(const Import& edit);

}  // namespace rebake
