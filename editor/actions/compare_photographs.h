#pragma once

#include "editor/actions/action.h"
#include "editor/actions/session.h"
#include "editor/fields/values.h"
#include "mesh_ops/scene/photo_camera.h"

namespace rebake {

/// Compares the scene with photographs from posed cameras.
struct ComparePhotographsAction {
  static constexpr const char* op = "compare_photographs";
  std::string cameras;             ///< camera file or folder of a capture
  CameraFormatName format;         ///< empty: recognised
  std::optional<WorldUp> world;    ///< as for import_views
  double scale = 1;                ///< factor of the cameras' positions
  std::string out;                 ///< folder for the table and pictures; empty: none
  int worst = 8;                   ///< number of views on the contact sheet
  int samples = 4;                 ///< samples per pixel: 1, 4 or 16
  bool gain = false;               ///< brings each picture to the exposure of its photograph first
  std::optional<double> min_psnr;  ///< in dB; a lower mean gives exit code 4

  /// The camera file and the photographs.
  static std::vector<std::filesystem::path> input_files(const nlohmann::json& object);
};
template <>
const ActionType& action_type<ComparePhotographsAction>();
template <>
ComparePhotographsAction read_action<ComparePhotographsAction>(const nlohmann::json& object, const Scene& scene);

/// Throws FieldError, FileError for missing photographs, DeviceError without OpenGL.
void run(Session& session, const ComparePhotographsAction& action);

}  // namespace rebake
