#pragma once

#include <imgui.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "editor/gui/panels/export_form.h"
#include "editor/gui/panels/folder_list.h"
#include "editor/gui/platform/desktop.h"
#include "editor/gui/state/editor_context.h"

namespace rebake {

/// File dialog to open, save, export and render. For exports it lists the properties of the scene that would be lost.
class FileDialog {
 public:
  /// Draws the dialog if `editor.dialogs.path` requests one, and performs the action when the user confirms.
  void draw(EditorContext& editor, Thumbnails& thumbnails);

  /// Closes the options or the comparison of plain folders; returns false if neither is open.
  bool close_popup(EditorContext& editor) { return import_options_.close() || export_.close_popup(editor.jobs); }
  /// Whether the desktop's own file dialog is open, which runs in another process.
  bool waits() const { return desktop_ != nullptr; }

 private:
  /// Resets the dialog for a new question.
  void begin(const EditorContext& editor);
  /// The picked nodes if only those are exported or rendered; otherwise empty, for all.
  std::vector<NodeRef> wanted_nodes(const EditorContext& editor) const;
  /// The parts of the dialog that an answer to the question needs.
  struct Form {
    bool exports = false, opens = false, film = false, pictures = false, writes = false;
    bool offers_picked = false;     ///< offers to restrict the output to the picked nodes
    std::string ending;             ///< file name extension of the answer; empty: a folder, or any
    std::string endings;            ///< extensions of the listed files, separated by spaces
    std::vector<std::string> lost;  ///< what an export would lose
  };
  Form form_for(const EditorContext& editor);
  bool draw_path();
  void open_paths(EditorContext& editor, const std::vector<std::string>& paths);
  bool draw_entries(const EditorContext& editor, Thumbnails& thumbnails, const Form& form);
  void draw_export_options(EditorContext& editor, const Form& form);
  void draw_picture_options(const Form& form);
  void check_path(const EditorContext& editor, const std::filesystem::path& path, const Form& form);
  bool confirm(EditorContext& editor, const std::filesystem::path& path, const Form& form, bool replaces);
  void draw_desktop_buttons(const EditorContext& editor, const std::string& ending);
  /// Takes the answer of the desktop's dialog, if it has one.
  void take_answer(EditorContext& editor);
  static int on_key(ImGuiInputTextCallbackData* data);
  /// Performs the action of the question. Throws Error.
  void perform_action(EditorContext& editor, const std::filesystem::path& path);
  std::string path_;
  FileDialogPurpose asked_ = FileDialogPurpose::none;  ///< question that the fields below are for
  FolderList list_;
  std::unique_ptr<DesktopFileDialog> desktop_;  ///< the desktop's dialog while it is open, else null
  std::string problem_, problem_path_;          ///< error message, and the path that it is about
  bool refocus_path_ = false;                   ///< the path field takes the keyboard focus in the next frame
  std::filesystem::path replacing_;             ///< existing path for which the user was asked about replacing it
  bool only_picked_ = false;                    ///< export or render only the picked nodes
  int width_ = 0, height_ = 0;                  ///< size of rendered images, pixels
  int pictures_ = 36;                           ///< number of images of a turntable or camera path
  bool video_ = false;                          ///< write a video instead of images
  ExportForm export_;
  FieldInputs import_;  ///< options of imports: fields of the edit `import`
  OptionsPopup import_options_;
};

}  // namespace rebake
