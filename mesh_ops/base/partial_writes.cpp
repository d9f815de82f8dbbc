#include "mesh_ops/base/partial_writes.h"

#include <set>
#include <thread>
#include <utility>

namespace rebake {

namespace fs = std::filesystem;

namespace {

struct Writes {
  std::timed_mutex mutex;
  std::multiset<fs::path> partial;
  bool abandoned = false;
};

// Never destroyed: threads may still write while the process ends.
Writes& writes() {
  static auto& one = *new Writes;
  return one;
}

}  // namespace

PartialWrite::PartialWrite(fs::path path) : path_(std::move(path)) {
  const std::lock_guard lock(writes().mutex);
  writes().partial.insert(path_);
}

PartialWrite::~PartialWrite() {
  const auto lock = committing();
  if (const auto found = writes().partial.find(path_); found != writes().partial.end()) writes().partial.erase(found);
}

std::unique_lock<std::timed_mutex> PartialWrite::committing() {
  std::unique_lock lock(writes().mutex);
  if (!writes().abandoned) return lock;
  lock.unlock();
  for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
}

void abandon_writes(std::chrono::milliseconds patience) {
  const std::unique_lock lock(writes().mutex, patience);
  if (!lock) return;
  writes().abandoned = true;
  // Repeated, because another thread may still be writing its current file.
  constexpr int tries = 3;
  for (int k = 0; k < tries; ++k)
    for (const fs::path& path : writes().partial) {
      std::error_code ignored;
      fs::remove_all(path, ignored);
    }
}

}  // namespace rebake
