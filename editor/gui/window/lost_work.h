#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

namespace rebake {

/// Unsaved work that an editor left behind in a journal.
struct LostWork {
  std::filesystem::path journal;
  std::string sources;    ///< names of what was imported; else the reason why the journal cannot be read
  std::size_t steps = 0;  ///< steps of history, undone ones not counted
  std::chrono::system_clock::time_point changed;  ///< when the last step was made
  bool discarded = false;                         ///< it lies in the trash
  /// "27 steps, 26 November 2026, 14:05", in local time.
  std::string words() const;
};

/// Days that discarded work stays in the trash.
inline constexpr int trash_days = 30;

/// Work of editors that ended without saving, the latest first. Also deletes work that was discarded more than
/// trash_days ago and removes thumbnails whose journal is gone.
std::vector<LostWork> lost_work();
/// Work in the trash, the latest first.
std::vector<LostWork> discarded_work();
/// Moves work to the trash. Throws std::filesystem::filesystem_error, also when another editor has recovered it.
void discard(const LostWork& work);
/// Moves discarded work back, and returns where its journal lies then. Throws std::filesystem::filesystem_error.
std::filesystem::path restore(const LostWork& work);

/// Where the thumbnail of a journal lies, if there is one. Moving the journal to the trash leaves it there.
std::filesystem::path thumbnail_file(const std::filesystem::path& journal);

}  // namespace rebake
