#include "mesh_ops/index/array_cache.h"

#include <tbb/task_arena.h>

#include <algorithm>

namespace rebake {

std::shared_ptr<ArrayCache::Entry> ArrayCache::entry_of(std::type_index type, const Arrays& arrays,
                                                        const Settings& settings) {
  std::vector<const void*> pointers;
  for (const auto& array : arrays) pointers.push_back(array.get());
  const std::scoped_lock lock(mutex_);
  entries_.remove_if([&](const std::shared_ptr<Entry>& entry) {
    const bool gone = std::any_of(entry->alive.begin(), entry->alive.end(), [](const auto& a) { return a.expired(); });
    if (gone) memory_ -= entry->bytes;
    return gone;
  });
  const auto found = std::find_if(entries_.begin(), entries_.end(), [&](const std::shared_ptr<Entry>& entry) {
    return entry->type == type && entry->arrays == pointers && entry->settings == settings;
  });
  if (found != entries_.end()) {
    entries_.splice(entries_.begin(), entries_, found);
    return entries_.front();
  }
  auto entry = std::shared_ptr<Entry>(new Entry{type, std::move(pointers), settings, {}, {}, {}, 0});
  for (const auto& array : arrays)
    if (array) entry->alive.emplace_back(array);
  entries_.push_front(entry);
  return entry;
}

void ArrayCache::isolated(const std::function<void()>& work) { tbb::this_task_arena::isolate(work); }

void ArrayCache::charge(Entry& charged, std::uint64_t bytes) {
  const std::scoped_lock lock(mutex_);
  const auto here =
      std::find_if(entries_.begin(), entries_.end(), [&](const auto& entry) { return entry.get() == &charged; });
  if (here == entries_.end()) return;  // its arrays were destroyed while it was computed
  charged.bytes = bytes;
  memory_ += bytes;
  for (auto last = entries_.end(); memory_ > budget_ && last != entries_.begin();) {
    --last;
    // An entry of 0 bytes is still being computed.
    if (last->get() == &charged || (*last)->bytes == 0) continue;
    memory_ -= (*last)->bytes;
    last = entries_.erase(last);
  }
}

std::uint64_t ArrayCache::memory() const {
  const std::scoped_lock lock(mutex_);
  return memory_;
}

std::size_t ArrayCache::size() const {
  const std::scoped_lock lock(mutex_);
  return static_cast<std::size_t>(
      std::count_if(entries_.begin(), entries_.end(), [](const auto& entry) { return entry->bytes > 0; }));
}

}  // namespace rebake
