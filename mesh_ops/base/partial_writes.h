#pragma once

#include <chrono>
#include <filesystem>
#include <mutex>

namespace rebake {

/// Registers a file or folder that is being written under a temporary name, so that abandon_writes() can remove it.
/// After abandon_writes(), committing() and the destructor block forever, so that no thread reports an error about the
/// missing file.
class PartialWrite {
 public:
  explicit PartialWrite(std::filesystem::path path);
  ~PartialWrite();
  PartialWrite(const PartialWrite&) = delete;
  PartialWrite& operator=(const PartialWrite&) = delete;

  /// Lock to hold while temporary files are moved into place; abandon_writes() waits for it.
  static std::unique_lock<std::timed_mutex> committing();

 private:
  std::filesystem::path path_;
};

/// For a process that exits without unwinding its threads: prevents further moves into place and removes all partial
/// writes. Waits at most `patience` for a move in progress, and removes nothing if it takes longer.
void abandon_writes(std::chrono::milliseconds patience);

}  // namespace rebake
