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

/// What was computed from immutable arrays, kept while these live and a budget lasts: whatever is used least recently
/// goes first. Keyed by the arrays themselves, so that scenes and objects that share them share it too, and an edit
/// that replaces some arrays loses only what was made of those. Callable from any thread: each value is made once, by
/// who asks first, and nobody waits for another one.
class ArrayCache {
 public:
  using Arrays = std::vector<std::shared_ptr<const void>>;
  using Settings = std::array<double, 2>;

  /// `budget` in bytes. What is being used goes on living beyond it.
  explicit ArrayCache(std::uint64_t budget) : budget_(budget) {}

  /// `make` returns a T. Values must not keep the arrays alive.
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
  /// Null where there is none, or it is being made.
  template <class T>
  std::shared_ptr<const T> if_there(const Arrays& arrays, const Settings& settings) {
    const std::shared_ptr<Entry> entry = entry_of(typeid(T), arrays, settings);
    const std::unique_lock lock(entry->making, std::try_to_lock);
    return lock ? std::static_pointer_cast<const T>(entry->value) : nullptr;
  }

  /// Bytes of what is kept.
  std::uint64_t memory() const;
  /// Values kept.
  std::size_t size() const;

 private:
  struct Entry {
    std::type_index type;
    std::vector<const void*> arrays;
    Settings settings;
    std::vector<std::weak_ptr<const void>> alive;  ///< the arrays: another one may come to lie at a place
    std::mutex making;
    std::shared_ptr<const void> value;
    std::uint64_t bytes = 0;
  };
  std::shared_ptr<Entry> entry_of(std::type_index type, const Arrays& arrays, const Settings& settings);
  /// Threads that help with one value do not begin another, which might wait for this one.
  static void isolated(const std::function<void()>& work);
  void charge(Entry& entry, std::uint64_t bytes);

  const std::uint64_t budget_;
  mutable std::mutex mutex_;
  std::list<std::shared_ptr<Entry>> entries_;  ///< the most recently used first
  std::uint64_t memory_ = 0;
};

}  // namespace rebake
