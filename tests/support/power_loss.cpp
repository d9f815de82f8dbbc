#include "tests/support/power_loss.h"

#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>

namespace rebake::test {

namespace fs = std::filesystem;

void PowerLoss::fail_at(int nth, int error) {
  fail_at_ = nth;
  error_ = error;
}

bool PowerLoss::fails() {
  if (calls_++ != fail_at_) return false;
  errno = error_;
  return true;
}

std::string PowerLoss::violations() const {
  std::string text;
  for (const std::string& one : violations_) text += one + "; ";
  for (const std::string& path : dirty_) text += path + " was never synced; ";
  return text;
}

int PowerLoss::open(const char* path, int flags, mode_t mode) {
  const bool writes = (flags & (O_WRONLY | O_RDWR)) != 0;
  if (writes && fails()) return -1;
  const bool is_new = !fs::exists(path);
  const int file = FileCalls::open(path, flags, mode);
  if (file < 0) return file;
  open_[file] = path;
  if (writes && (is_new || (flags & O_TRUNC) != 0)) dirty_.insert(path);
  if (is_new) dirty_.insert(fs::path(path).parent_path());
  return file;
}

ssize_t PowerLoss::pwrite(int file, const void* bytes, std::size_t count, off_t at) {
  if (fails()) return -1;
  dirty_.insert(open_[file]);
  return FileCalls::pwrite(file, bytes, std::min(count, max_), at);
}

int PowerLoss::ftruncate(int file, off_t size) {
  dirty_.insert(open_[file]);
  return FileCalls::ftruncate(file, size);
}

int PowerLoss::fsync(int file) {
  if (fails()) return -1;
  dirty_.erase(open_[file]);
  log_.push_back("sync " + open_[file]);
  return FileCalls::fsync(file);
}

int PowerLoss::close(int file) {
  open_.erase(file);
  return FileCalls::close(file);
}

int PowerLoss::mkdir(const char* path, mode_t mode) {
  if (fails()) return -1;
  const int result = FileCalls::mkdir(path, mode);
  if (result == 0) {
    dirty_.insert(path);
    dirty_.insert(fs::path(path).parent_path());
  }
  return result;
}

int PowerLoss::rename(const char* from, const char* to, unsigned flags) {
  if (fails()) return -1;
  log_.push_back(std::string("rename ") + from + " " + to);
  for (const std::string& path : dirty_)
    if (path == from || path.starts_with(std::string(from) + "/"))
      violations_.push_back(path + " was renamed before it was synced");
  const int result = FileCalls::rename(from, to, flags);
  if (result != 0) return result;
  ++renames_;
  // Both folders have changed; files that were created below `from` have other paths now.
  std::erase_if(dirty_,
                [&](const std::string& path) { return path == from || path.starts_with(std::string(from) + "/"); });
  dirty_.insert(fs::path(from).parent_path());
  dirty_.insert(fs::path(to).parent_path());
  return result;
}

int PowerLoss::unlink(const char* path) {
  log_.push_back(std::string("unlink ") + path);
  const int result = FileCalls::unlink(path);
  dirty_.erase(path);
  if (result == 0) dirty_.insert(fs::path(path).parent_path());
  return result;
}

}  // namespace rebake::test
