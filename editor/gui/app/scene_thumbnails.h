#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <string>

#include "editor/gui/panels/panels.h"

namespace rebake {

/// Writes thumbnails of the current scene: for the list of recent files and for the recovery dialog. Failures are
/// ignored; an icon is then shown instead. `renderer` holds the picture that the viewport shows.
class SceneThumbnails {
 public:
  /// The thumbnail of the document's journal: after each step, but at most every two seconds.
  void write_for_recovery(const EditorContext& editor, Renderer& renderer);
  /// The thumbnail of the file or folder that was just opened or saved.
  void write_for_recent_files(const EditorContext& editor, Renderer& renderer);
  Thumbnails& of_recent_files() { return thumbnails_; }
  const Thumbnails& of_recent_files() const { return thumbnails_; }

 private:
  using Clock = std::chrono::steady_clock;

  Thumbnails thumbnails_;
  std::string recent_file_;         ///< file or folder of the last thumbnail in the list of recent files
  std::size_t recent_step_ = 0;     ///< number of steps of history at that thumbnail
  std::filesystem::path journal_;   ///< journal of the last recovery thumbnail
  std::size_t journal_step_ = 0;    ///< number of steps of history at that thumbnail
  Clock::time_point journal_time_;  ///< when it was written
};

}  // namespace rebake
