#pragma once

#include <sys/stat.h>
#include <sys/types.h>

#include <cstddef>
#include <cstdint>

namespace rebake {

/// System calls that write and identify files, in one replaceable place: tests record their order, make one fail or
/// fake results. Each function has the result of the system call of the same name, and sets errno.
class FileCalls {
 public:
  virtual ~FileCalls() = default;
  virtual int open(const char* path, int flags, mode_t mode);
  virtual ssize_t pwrite(int file, const void* bytes, std::size_t count, off_t at);
  virtual int ftruncate(int file, off_t size);
  virtual int fsync(int file);
  virtual int close(int file);
  virtual int mkdir(const char* path, mode_t mode);
  /// `flags` as for renameat2(2).
  virtual int rename(const char* from, const char* to, unsigned flags);
  virtual int unlink(const char* path);
  virtual int stat(const char* path, struct stat* about);
  /// When a file was created, in nanoseconds; 0 if the file system does not tell.
  virtual std::int64_t birth_time(const char* path);
};

/// The instance in use.
FileCalls& file_calls();

/// Replaces the instance in use during its own lifetime. For single-threaded tests.
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
