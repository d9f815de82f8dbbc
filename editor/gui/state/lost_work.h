#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

namespace rebake {

/// Unsaved work that an editor left behind in a journal.
struct LostWork {
  std::filesystem::path journal;
  std::string sources;    ///< names of the imported scenes; else the reason why the journal cannot be read
  std::size_t steps = 0;  ///< number of steps of history, without undone ones
  std::chrono::system_clock::time_point changed;  ///< time of the last step, or of discarding
  bool discarded = false;                         ///< the journal is in the trash
  /// "27 steps, 26 November 2026, 14:05", in local time.
  std::string words() const;
};

/// Days that discarded work stays in the trash.
inline constexpr int trash_days = 30;

/// Finds work of editors that ended without saving, latest first. Also deletes work that was discarded more than
/// trash_days ago and removes thumbnails whose journal is gone.
std::vector<LostWork> lost_work();
/// Work in the trash, latest first.
std::vector<LostWork> discarded_work();
/// Moves work to the trash. Throws std::filesystem::filesystem_error, also when another editor has recovered it.
void discard(const LostWork& work);
/// Moves discarded work back and returns the new path of its journal. Throws std::filesystem::filesystem_error.
std::filesystem::path restore(const LostWork& work);

/// Path of a journal's thumbnail, which may not exist. It is the same when the journal is in the trash.
std::filesystem::path thumbnail_path(const std::filesystem::path& journal);

}  // namespace rebake
