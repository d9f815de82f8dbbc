#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <typeindex>
#include <vector>

namespace rebake {

/// Cache of values computed from immutable arrays, keyed by value type, array addresses and settings. Scenes that share
/// arrays share the values, and an edit that replaces some arrays invalidates only values derived from these. Values
/// are dropped with their arrays, and the least recently used ones are evicted beyond a memory budget. Thread-safe:
/// each value is computed once, by its first caller, and callers for other values do not wait.
class ArrayCache {
 public:
  using Arrays = std::vector<std::shared_ptr<const void>>;
  using Settings = std::array<double, 2>;

  /// `budget` in bytes. Evicted values stay alive while in use.
  explicit ArrayCache(std::uint64_t budget) : budget_(budget) {}

  /// Returns the cached T, or computes it with `make()`. A T must not own the arrays, and memory_of(T) must give its
  /// size in bytes.
  template <class T, class Make>
  std::shared_ptr<const T> get(const Arrays& arrays, const Settings& settings, Make make) {
    const std::shared_ptr<Entry> entry = entry_of(typeid(T), arrays, settings);
    const std::scoped_lock lock(entry->making);
    if (!entry->value) {
      std::shared_ptr<const T> value;
      isolated([&] { value = std::make_shared<const T>(make()); });
      entry->value = value;
      charge(*entry, memory_of(*value));
    }
    return std::static_pointer_cast<const T>(entry->value);
  }
  /// Returns the cached T; null if there is none or it is still being computed.
  template <class T>
  std::shared_ptr<const T> try_get(const Arrays& arrays, const Settings& settings) {
    const std::shared_ptr<Entry> entry = entry_of(typeid(T), arrays, settings);
    const std::unique_lock lock(entry->making, std::try_to_lock);
    return lock ? std::static_pointer_cast<const T>(entry->value) : nullptr;
  }

  /// Total size of the cached values, in bytes.
  std::uint64_t memory() const;
  /// Number of cached values.
  std::size_t size() const;

 private:
  struct Entry {
    std::type_index type;
    std::vector<const void*> arrays;
    Settings settings;
    std::vector<std::weak_ptr<const void>> alive;  ///< the non-null arrays; an expired one's address may be reused
    std::mutex making;                             ///< locked while the value is computed
    std::shared_ptr<const void> value;
    std::uint64_t bytes = 0;  ///< 0 while the value is computed
  };
  std::shared_ptr<Entry> entry_of(std::type_index type, const Arrays& arrays, const Settings& settings);
  /// Runs `work` in a TBB isolation: a thread that helps compute one value must not start another, which might wait for
  /// this one.
  static void isolated(const std::function<void()>& work);
  /// Records the size of a computed value, and evicts others beyond the budget.
  void charge(Entry& entry, std::uint64_t bytes);

  const std::uint64_t budget_;
  mutable std::mutex mutex_;
  std::list<std::shared_ptr<Entry>> entries_;  ///< most recently used first
  std::uint64_t memory_ = 0;
};

}  // namespace rebake
