#pragma once

#include <imgui.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "editor/gui/panels/folder_list.h"
#include "editor/gui/panels/plain_preview.h"
#include "editor/gui/window/desk.h"
#include "editor/gui/window/desktop.h"

namespace rebake {

/// Asks for a path; says what an export can and cannot keep.
class FileDialog {
 public:
  /// Where one is asked for.
  void draw(Desk& desk, Thumbnails& thumbnails);

  /// Goes back from comparing plain folders to the path; false where nobody compares.
  bool leaves_comparing(Desk& desk) { return preview_.leave(desk); }
  /// Whether another program's answer is waited for.
  bool waits() const { return desktop_ != nullptr; }

 private:
  void begin(const Desk& desk);
  std::vector<NodeRef> wanted_nodes(const Desk& desk) const;
  void draw_desktop_buttons(const Desk& desk, const std::string& ending);
  void take_answer(Desk& desk);
  static int on_key(ImGuiInputTextCallbackData* data);
  void carry_out(Desk& desk, const std::filesystem::path& path);
  std::string path_;
  PathQuestion asked_ = PathQuestion::none;
  FolderList list_;
  std::unique_ptr<DesktopFileDialog> desktop_;  ///< while it is open
  std::string problem_, problem_of_;            ///< what is wrong with which path
  bool refocuses_ = false;                      ///< the path takes the keyboard again
  std::filesystem::path replacing_;             ///< is there already: asked for once
  bool only_picked_ = false;                    ///< of an export, or in pictures
  int width_ = 0, height_ = 0;                  ///< of pictures, in pixels
  int pictures_ = 36;                           ///< of a film
  bool video_ = false;
  bool plain_ = false;  ///< of an export: one folder for all
  PlainPreview preview_;
};

}  // namespace rebake
