#pragma once

#include "editor/actions/action.h"
#include "editor/actions/session.h"
#include "editor/fields/values.h"
#include "mesh_ops/features/distill/fuse.h"
#include "mesh_ops/formats/export.h"

namespace rebake {

/// Exports the scene in a format of the table (formats.h). In the MobileNeRF format: one folder, or a scene.json with
/// several folders if one cannot represent the scene exactly.
struct ExportAction {
  static constexpr const char* op = "export";
  std::string out;                    ///< folder to write
  std::optional<Layout> layout;       ///< nothing: as read
  FormatName format;                  ///< a format of the table
  bool plain = false;                 ///< always one folder: fits one decoder to the whole scene if needed
  FuseWidth width;                    ///< plain: maximum width of the decoder's hidden layers
  std::optional<FuseMethod> way;      ///< plain: method of fusing decoders; nothing: the best
  std::string keep = "auto";          ///< plain: name of the node that stays bit for bit, none, or auto
  std::optional<double> psnr;         ///< plain: requested PSNR in dB; nothing: 40, fits all texels
  double seconds = 0;                 ///< plain: time limit of fitting; 0: none
  std::string report;                 ///< plain: JSON file for the measured errors; empty: none
  std::optional<int> page_size;       ///< maximum side of repacked textures, in texels; nothing: largest_page_side()
  int picture_size = 800;             ///< plain: side of the pictures for measuring, in pixels
  std::string view;                   ///< gltf: colours as seen from this stored view; empty: means
  std::vector<std::string> compress;  ///< gltf: see gltf_compression()
  std::vector<NodeRef> nodes;         ///< only these and their children; empty: all
};
template <>
const ActionType& action_type<ExportAction>();
template <>
ExportAction read_action<ExportAction>(const nlohmann::json& object, const Scene& scene);

/// Options for fitting a plain folder. Throws FieldError.
FuseOptions fuse_options(const Scene& scene, const ExportAction& action);

/// Writes the scene without measuring how pictures change; not for plain folders. Throws as run() does.
ExportReport write_export(Session& session, const ExportAction& action);

/// Throws FieldError for invalid fields, FileError if the folder cannot be written.
void run(Session& session, const ExportAction& action);

}  // namespace rebake
