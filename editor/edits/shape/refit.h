#pragma once

#include "editor/edits/support.h"
#include "mesh_ops/scene/photo_camera.h"

namespace rebake {

/// Fits the colours of objects to photographs from posed cameras.
struct Refit {
  static constexpr const char* op = "refit";
  static constexpr const char* done = "Refitted";
  static constexpr const char* source_field = "path";
  std::string path;              ///< camera file or folder, as for import_views
  CameraFormatName format;       ///< empty: recognised
  std::optional<WorldUp> world;  ///< as for import_views
  double scale = 1;              ///< factor of the cameras' positions
  std::optional<NodeRef> node;   ///< nothing: all visible, unlocked objects
  bool selection = false;        ///< only texels of selected triangles
  bool decoder = false;          ///< fits the decoders too
  bool gain = false;             ///< each photograph has its own exposure
  int epochs = 40;               ///< with decoder: passes over all texels
  std::string content;           ///< expected hash of the camera files; empty: any
  std::string photographs;       ///< expected hash of the photographs; empty: any

  EditSource input() const;
  void set_input(const EditSource& source);
  std::vector<std::filesystem::path> input_files() const;
  std::string input_problem() const;
};
template <>
const EditType& edit_type<Refit>();

Outcome apply(const Scene& scene, const Refit& edit, const Progress& progress = {});

}  // namespace rebake
