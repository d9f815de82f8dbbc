#pragma once

#include <chrono>
#include <filesystem>
#include <mutex>

namespace rebake {

/// A file or folder that is being written under a temporary name. Known to abandon_writes() until it is destroyed;
/// after that call neither committing() nor the destructor returns, so that its thread says nothing about the missing
/// file.
class PartialWrite {
 public:
  explicit PartialWrite(std::filesystem::path path);
  ~PartialWrite();
  PartialWrite(const PartialWrite&) = delete;
  PartialWrite& operator=(const PartialWrite&) = delete;

  /// Held while temporary files are moved into place: abandon_writes() waits until then.
  static std::unique_lock<std::timed_mutex> committing();

 private:
  std::filesystem::path path_;
};

/// For a process that ends without unwinding its threads: lets nothing be moved into place any more, and removes what
/// is being written. Waits at most `patience` for a move that has begun, and then removes nothing.
void abandon_writes(std::chrono::milliseconds patience);

}  // namespace rebake
