#pragma once

#include "editor/commands/action.h"
#include "editor/commands/session.h"
#include "editor/fields/values.h"
#include "mesh_ops/features/fuse.h"

namespace rebake {

/// Writes the scene in a format of the table; in MobileNeRF's, as scene.json where one folder cannot hold it.
struct ExportAction {
  static constexpr const char* op = "export";
  std::string out;
  std::string format = "mobilenerf";
  std::optional<Layout> layout;
  std::optional<int> page_size;  ///< texels a side of textures that are laid out again, at most; nothing: as read
  std::vector<NodeRef> nodes;    ///< only these and what is inside them; empty: all
  bool plain = false;            ///< one folder whatever it takes: fits one decoder to all of it
  FuseWidth width;
  std::optional<FuseWay> way;  ///< nothing: whichever is best
  std::string keep = "auto";   ///< of a plain folder: a node that stays bit for bit, none, or auto
  std::optional<double> psnr;  ///< dB that a plain folder is to reach
  double seconds = 0;          ///< that fitting may take; 0: as long as it takes
  int picture_size = 800;      ///< pixels a side of the pictures that a plain folder is judged by
  std::string report;          ///< file for what was measured, as JSON; empty: none
};
template <>
const ActionType& action_type<ExportAction>();

/// How the action fits a plain folder. Throws FieldError.
FuseOptions fuse_options(const Scene& scene, const ExportAction& action);

/// Throws FieldError where fields are given that only a plain folder has.
void check_not_plain(const ExportAction& action);

void run(Session& session, const ExportAction& action);

}  // namespace rebake
