#pragma once

#include <sys/types.h>

#include <cstddef>

namespace rebake {

/// What writing asks of the system, all in one place: tests put another in its stead, to see the order of calls and to
/// let one fail. Each returns what the call of its name does, and sets errno.
class FileCalls {
 public:
  virtual ~FileCalls() = default;
  virtual int open(const char* path, int flags, mode_t mode);
  virtual ssize_t pwrite(int file, const void* bytes, std::size_t count, off_t at);
  virtual int ftruncate(int file, off_t size);
  virtual int fsync(int file);
  virtual int close(int file);
  virtual int mkdir(const char* path, mode_t mode);
  /// `flags` as of renameat2.
  virtual int rename(const char* from, const char* to, unsigned flags);
  virtual int unlink(const char* path);
};

/// Those in use.
FileCalls& file_calls();

/// Puts others in use while it lives. For tests, on one thread.
class ReplacedFileCalls {
 public:
  explicit ReplacedFileCalls(FileCalls& calls);
  ~ReplacedFileCalls();
  ReplacedFileCalls(const ReplacedFileCalls&) = delete;
  ReplacedFileCalls& operator=(const ReplacedFileCalls&) = delete;

 private:
  FileCalls* before_;
};

}  // namespace rebake
