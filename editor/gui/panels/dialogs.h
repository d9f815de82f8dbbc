#pragma once

#include "editor/gui/panels/file_dialog.h"

namespace rebake {

/// Asks before work is lost, and for paths: one question at a time, the most urgent first.
class Dialogs {
 public:
  void draw(Desk& desk, Thumbnails& thumbnails);
  /// Answers the question that is open with "not now"; false when none is.
  bool escape(Desk& desk);
  /// Closes what Dear ImGui has open, with the next frame.
  void close_popups() { closes_ = true; }
  /// Whether another program's answer is waited for.
  bool waits() const { return files_.waits(); }
  /// True once the window may close.
  bool may_quit() const { return may_quit_; }

 private:
  void draw_recovery(Project& project, Thumbnails& thumbnails);
  void draw_lost(Project& project, Thumbnails& thumbnails, const LostWork& work, bool first);
  void draw_discarding(Project& project);
  void draw_quitting(Desk& desk);
  void draw_replacing(Desk& desk);
  void draw_relinking(Project& project);
  FileDialog files_;
  std::optional<LostWork> chosen_;      ///< to be recovered
  std::optional<LostWork> discarding_;  ///< the work that a question asks about
  bool may_quit_ = false, closes_ = false;
};

}  // namespace rebake
