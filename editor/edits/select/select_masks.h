#pragma once

#include "editor/edits/select/selecting.h"
#include "mesh_ops/scene/photo_camera.h"

namespace rebake {

/// Selects triangles that are inside masks of photographs, by votes of the photographs.
struct SelectMasks {
  static constexpr const char* op = "select_masks";
  static constexpr bool selects = true;
  static constexpr const char* source_field = "path";
  std::string path;              ///< camera file or folder, as for import_views
  CameraFormatName format;       ///< empty: recognised
  std::string masks;             ///< folder of masks or COCO file, relative to the capture's folder; empty: default
  std::optional<WorldUp> world;  ///< as for import_views
  double scale = 1;              ///< factor of the cameras' positions
  std::optional<NodeRef> node;   ///< nothing: all visible, unlocked objects
  std::vector<int> labels;       ///< values of pixels; empty: 128 … 255 are inside
  double threshold = 0.5;        ///< share of the votes that a triangle needs
  std::string store;             ///< stores the triangles of each label as "store LABEL"; empty: not
  SelectMode mode = SelectMode::set;
  std::string content;        ///< expected hash of the camera files; empty: any
  std::string masks_content;  ///< expected hash of the masks; empty: any

  EditSource input() const;
  void set_input(const EditSource& source);
  std::vector<std::filesystem::path> input_files() const;
  std::string input_problem() const;
};
template <>
const EditType& edit_type<SelectMasks>();

Outcome apply(const Scene& scene, const SelectMasks& edit, const Progress& progress = {});

}  // namespace rebake
