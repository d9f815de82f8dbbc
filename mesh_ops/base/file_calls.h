#pragma once

#include <sys/stat.h>
#include <sys/types.h>

#include <cstddef>

namespace rebake {

/// System calls for writing and for telling files apart, in one place: tests replace them to see the order of calls, to
/// let one fail or to inject answers. Each returns what the call of its name does, and sets errno.
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
  virtual int stat(const char* path, struct stat* about);
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
