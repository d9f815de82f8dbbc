#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "editor/actions/export_action.h"
#include "editor/gui/panels/field_inputs.h"
#include "editor/gui/panels/options_popup.h"
#include "editor/gui/panels/plain_preview.h"
#include "editor/gui/state/tool_context.h"
#include "mesh_ops/formats/formats.h"

namespace rebake {

/// The part of the file dialog for exports: format, options, the comparison of plain folders, and losses.
class ExportForm {
 public:
  /// Sets all options to their defaults.
  void reset() { inputs_ = {}; }
  /// Draws format and options. `nodes`: nodes to export; empty for all. `problem`: error message of the last try.
  void draw(ToolContext& editor, const std::vector<NodeRef>& nodes, const std::string& problem);
  /// Draws the comparison of plain folders if it is open.
  void draw_comparison(Jobs& jobs);
  /// Closes the popup with more options or the comparison; returns false if neither is open.
  bool close_popup(Jobs& jobs);
  /// Tells that the dialog is closed.
  void leave() { options_.leave(); }

  const Format& format() const;
  /// Lines of text about everything that an export of this scene loses.
  std::vector<std::string> losses(const Scene& scene) const;
  /// The export to `path`. Throws FieldError for invalid options.
  ExportAction action(const Scene& scene, const std::vector<NodeRef>& nodes, const std::filesystem::path& path) const;

 private:
  bool is_plain() const { return inputs_.values().value("plain", false); }
  std::string choice_words() const;
  std::vector<FieldInfo> other_fields() const;
  void draw_format_choice();

  FieldInputs inputs_;  ///< fields of ExportAction
  OptionsPopup options_;
  PlainPreview preview_;
};

}  // namespace rebake
