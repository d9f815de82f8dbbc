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
  /// Waits up to ten seconds; then throws FileError.
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int folder_;
};

}  // namespace rebake
