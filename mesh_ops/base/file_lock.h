#pragma once

#include <filesystem>

namespace rebake {

/// Exclusive lock on a file among processes (flock): held until destruction, and freed if the process dies. The file is
/// created if needed, and stays.
class FileLock {
 public:
  /// Tries to lock without waiting. Throws FileError if the file cannot be opened.
  explicit FileLock(const std::filesystem::path& path);
  ~FileLock();
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

  /// False if another lock is held. True on file systems without locks.
  bool held() const { return held_; }

 private:
  int file_;
  bool held_;
};

/// Exclusive lock on a folder among processes. Without effect for folders that cannot be opened and on file systems
/// without locks.
class FolderLock {
 public:
  enum class Wait { ten_seconds, no };
  /// If another lock is held, waits ten seconds and then throws FileError, or returns without lock.
  explicit FolderLock(const std::filesystem::path& folder, Wait wait = Wait::ten_seconds);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

  /// False if another lock is held.
  bool held() const { return held_; }

 private:
  int folder_;
  bool held_ = true;
};

}  // namespace rebake
