#pragma once

#include "editor/edits/support.h"
#include "mesh_ops/scene/photo_camera.h"

namespace rebake {

/// Stores the cameras of a file as named views.
struct ImportViews {
  static constexpr const char* op = "import_views";
  static constexpr const char* source_field = "path";
  std::string path;              ///< file or folder of a format in the table camera_formats()
  CameraFormatName format;       ///< empty: recognised
  std::string prefix;            ///< start of the views' names, which go on with those of the photographs
  std::optional<WorldUp> world;  ///< the axis that points up in the file; nothing: as usual for the format
  double scale = 1;              ///< factor of positions
  std::string content;           ///< expected hash of the files; empty: any

  EditSource input() const;
  void set_input(const EditSource& source);
  std::vector<std::filesystem::path> input_files() const;
};
template <>
const EditType& edit_type<ImportViews>();

Outcome apply(const Scene& scene, const ImportViews& edit);
/// Title of a step: see EditType::title.
std::string whole_title(const ImportViews& edit);

}  // namespace rebake
