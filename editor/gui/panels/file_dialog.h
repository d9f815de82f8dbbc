#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "editor/gui/window/desk.h"

namespace rebake {

/// Asks for a path; says what an export can and cannot keep.
class FileDialog {
 public:
  /// Where one is asked for.
  void draw(Desk& desk);

 private:
  struct Entry {
    std::filesystem::path path;
    bool is_folder = false, is_scene = false;
  };
  void begin(const Desk& desk);
  std::vector<NodeRef> exported_nodes(const Desk& desk) const;
  bool draw_entries(const Desk& desk, const std::filesystem::path& folder, const std::string& ending);
  void carry_out(Desk& desk, const std::filesystem::path& path);
  std::string path_;
  PathQuestion asked_ = PathQuestion::none;
  std::filesystem::path entries_of_;  ///< the folder that was read
  std::vector<Entry> entries_;
  std::string problem_, problem_of_;  ///< what is wrong with which path
  bool refocuses_ = false;            ///< the path takes the keyboard again
  std::filesystem::path replacing_;   ///< is there already: asked for once
  bool only_picked_ = false;          ///< of an export
  int width_ = 0, height_ = 0;        ///< of pictures, in pixels
  int pictures_ = 36;                 ///< of a turntable
};

}  // namespace rebake
