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

}  // namespace rebake
