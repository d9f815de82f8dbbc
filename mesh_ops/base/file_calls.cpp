#include "mesh_ops/base/file_calls.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>

namespace rebake {

int FileCalls::open(const char* path, int flags, mode_t mode) { return ::open(path, flags, mode); }
ssize_t FileCalls::pwrite(int file, const void* bytes, std::size_t count, off_t at) {
  return ::pwrite(file, bytes, count, at);
}
int FileCalls::ftruncate(int file, off_t size) { return ::ftruncate(file, size); }
int FileCalls::fsync(int file) { return ::fsync(file); }
int FileCalls::close(int file) { return ::close(file); }
int FileCalls::mkdir(const char* path, mode_t mode) { return ::mkdir(path, mode); }
int FileCalls::rename(const char* from, const char* to, unsigned flags) {
  return flags == 0 ? ::rename(from, to) : ::renameat2(AT_FDCWD, from, AT_FDCWD, to, flags);
}
int FileCalls::unlink(const char* path) { return ::unlink(path); }
int FileCalls::stat(const char* path, struct stat* about) { return ::stat(path, about); }
std::int64_t FileCalls::birth_time(const char* path) {
  struct statx about {};
  if (::statx(AT_FDCWD, path, 0, STATX_BTIME, &about) != 0 || (about.stx_mask & STATX_BTIME) == 0) return 0;
  constexpr std::int64_t nanoseconds = 1'000'000'000;
  return about.stx_btime.tv_sec * nanoseconds + about.stx_btime.tv_nsec;
}

namespace {

FileCalls system_calls;
std::atomic<FileCalls*> in_use = &system_calls;

}  // namespace

FileCalls& file_calls() { return *in_use.load(); }

ReplacedFileCalls::ReplacedFileCalls(FileCalls& calls) : before_(in_use.exchange(&calls)) {}
ReplacedFileCalls::~ReplacedFileCalls() { in_use = before_; }

}  // namespace rebake
