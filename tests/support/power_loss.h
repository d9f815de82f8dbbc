#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "mesh_ops/base/file_calls.h"

namespace rebake::test {

/// Carries calls out and watches what a power loss after any of them would leave: a file that takes another's name must
/// be on the disk before, with all that it holds, and the folder that names it after. Can let the nth call fail, and
/// write little at a time.
class PowerLoss final : public FileCalls {
 public:
  /// The call with this number (from 0; opening to read, closing and removing are not counted) fails so.
  void fail_at(int nth, int error);
  void write_at_most(std::size_t bytes) { most_ = bytes; }

  /// What is wrong so far, with folders that are not synced yet; empty when nothing is.
  std::string trouble() const;
  std::size_t renames() const { return renames_; }
  /// Names of what was done, e.g. "rename a b".
  const std::vector<std::string>& log() const { return log_; }

  int open(const char* path, int flags, mode_t mode) override;
  ssize_t pwrite(int file, const void* bytes, std::size_t count, off_t at) override;
  int ftruncate(int file, off_t size) override;
  int fsync(int file) override;
  int close(int file) override;
  int mkdir(const char* path, mode_t mode) override;
  int rename(const char* from, const char* to, unsigned flags) override;
  int unlink(const char* path) override;

 private:
  bool fails();

  std::map<int, std::string> open_;  ///< paths of open files
  std::set<std::string> dirty_;      ///< files and folders that were changed since they were synced
  std::vector<std::string> log_, trouble_;
  std::size_t renames_ = 0, most_ = ~std::size_t{0};
  int calls_ = 0, fail_at_ = -1, error_ = 0;
};

}  // namespace rebake::test
