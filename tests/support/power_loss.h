#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "mesh_ops/base/file_calls.h"

namespace rebake::test {

/// Executes file calls and checks that a power loss after any of them is harmless: a file must be synced before it is
/// renamed, and its folder afterwards. Can make one call fail, and limit the bytes per write.
class PowerLoss final : public FileCalls {
 public:
  /// Lets call number `nth` (from 0) fail with `error`. Not counted: opening for reading, truncating, closing,
  /// removing.
  void fail_at(int nth, int error);
  void write_at_most(std::size_t bytes) { max_ = bytes; }

  /// Violations so far, and files and folders that are not synced yet; empty if there are none.
  std::string violations() const;
  std::size_t renames() const { return renames_; }
  /// Syncs, renames and removals so far, e.g. "rename a b".
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
  std::vector<std::string> log_, violations_;
  std::size_t renames_ = 0, max_ = ~std::size_t{0};
  int calls_ = 0, fail_at_ = -1, error_ = 0;
};

}  // namespace rebake::test
