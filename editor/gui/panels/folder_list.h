#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "editor/gui/view/thumbnails.h"

namespace rebake {

/// What lies in a folder, to choose from: scenes, folders, and files of some endings.
class FolderList {
 public:
  struct Entry {
    std::filesystem::path path;
    bool is_folder = false, is_scene = false;
  };

  /// Reads the folder, where it is another one or `again`. `endings` of files, such as ".png .jpg".
  void look_at(const std::filesystem::path& folder, const std::string& endings, bool again = false);
  /// Shows only what holds the text in its name, whatever the case; all where nothing does, or one has that very name.
  void filter(const std::string& name);

  struct Taken {
    std::filesystem::path path;  ///< clicked; empty for nothing
    bool at_once = false;        ///< twice
  };
  /// `several`: with Ctrl and Shift more than one is chosen.
  Taken draw(Thumbnails& thumbnails, bool opens, bool several);
  /// What the arrow keys come to, from the chosen one; nothing in an empty list.
  std::filesystem::path step(int by);
  /// The name as far as it can be completed from what there is.
  std::string completed(const std::string& name) const;

  const std::set<std::filesystem::path>& chosen() const { return chosen_; }
  void choose_none() { chosen_.clear(); }

 private:
  std::filesystem::path folder_;
  std::string endings_;
  std::vector<Entry> entries_;
  std::vector<const Entry*> shown_;
  std::set<std::filesystem::path> chosen_;
  std::filesystem::path last_;  ///< clicked or stepped to: where Shift begins
  bool scrolls_ = false;        ///< to it
};

/// Whether some format knows the folder.
bool holds_scene(const std::filesystem::path& folder);

}  // namespace rebake
