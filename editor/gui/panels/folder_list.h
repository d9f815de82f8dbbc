#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "editor/gui/view/thumbnails.h"

namespace rebake {

/// Widget that lists a folder's scenes, subfolders and files with given extensions, for the user to choose from.
class FolderList {
 public:
  struct Entry {
    std::filesystem::path path;
    bool is_folder = false, is_scene = false;
  };

  /// Reads the folder if it or `endings` has changed, or if `again` is set. `endings`: extensions of the listed files,
  /// separated by spaces, e.g. ".png .jpg".
  void look_at(const std::filesystem::path& folder, const std::string& endings, bool again = false);
  /// Shows only entries whose name contains the text, ignoring case. Shows all if no name does, or if one equals it.
  void filter(const std::string& name);

  /// Result of one frame of draw().
  struct Taken {
    std::filesystem::path path;  ///< clicked entry; empty if none; ends with / if the folder is to be entered
    bool at_once = false;        ///< it was double-clicked
  };
  /// Draws the list. `opens`: a click chooses a scene folder instead of entering it. `several`: Ctrl and Shift choose
  /// more than one entry.
  Taken draw(Thumbnails& thumbnails, bool opens, bool several);
  /// Moves the choice by `by` entries (arrow keys) and returns its path; empty if the list is empty.
  std::filesystem::path step(int by);
  /// Completes a name to the longest common prefix of the entries that start with it, ignoring case.
  std::string completed(const std::string& name) const;

  const std::set<std::filesystem::path>& chosen() const { return chosen_; }
  void clear_choice() { chosen_.clear(); }

 private:
  std::filesystem::path folder_;
  std::string endings_;
  std::vector<Entry> entries_;
  std::vector<const Entry*> shown_;
  std::set<std::filesystem::path> chosen_;
  std::filesystem::path last_;  ///< entry clicked or stepped to last: one end of a Shift range
  bool scrolls_ = false;        ///< scroll to `last_` in the next frame
};

/// Whether the path has one of these extensions, which are separated by spaces. Ignores case.
bool has_ending(const std::filesystem::path& path, const std::string& endings);
/// Whether the folder or file is a scene in a known format.
bool holds_scene(const std::filesystem::path& path);

}  // namespace rebake
