#pragma once

#include "editor/gui/panels/file_dialog.h"

namespace rebake {

/// Modal dialogs: unsaved changes, recovery of journals, missing sources, and file paths. Only the most urgent one is
/// open.
class Dialogs {
 public:
  void draw(EditorContext& editor, Thumbnails& thumbnails);
  /// Cancels the open dialog; returns false if none is open.
  bool escape(EditorContext& editor);
  /// Closes all Dear ImGui popups in the next frame.
  void close_popups() { closes_ = true; }
  /// Whether the desktop's own file dialog is open, which runs in another process.
  bool waits() const { return files_.waits(); }
  /// Whether the window may close: nothing was unsaved, or the user has decided.
  bool may_quit() const { return may_quit_; }

 private:
  void draw_recovery(Project& project, Thumbnails& thumbnails);
  void draw_lost(Project& project, Thumbnails& thumbnails, const LostWork& work, bool first);
  void draw_discarding(Project& project);
  void draw_quitting(EditorContext& editor);
  void draw_replacing(EditorContext& editor);
  void draw_relinking(Project& project);
  FileDialog files_;
  std::optional<LostWork> chosen_;          ///< journal that the user chose to recover
  std::optional<LostWork> discarding_;      ///< journal that the user is asked about discarding
  bool may_quit_ = false, closes_ = false;  ///< see may_quit(); see close_popups()
};

}  // namespace rebake
