#pragma once

#include <tbb/blocked_range.h>
#include <tbb/partitioner.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <type_traits>
#include <utility>

/// Replaces TBB's loops in builds with the thread sanitizer. TBB is not built with the sanitizer, which therefore
/// reports its synchronisation as races, but knows threads of the standard library. Nested loops run sequentially.
/// Cancellation by contexts is not implemented.
namespace tbb {

/// Whether this thread executes a block of a loop.
inline thread_local bool inside_loop = false;

/// Calls `body(begin, end)` for blocks of at least `grain`, assigned to three threads in turn. Only the loop's begin
/// and end synchronise, so data races are found whichever thread runs first. Rethrows the first exception; blocks that
/// have not begun by then are skipped.
template <class Value, class Body>
void for_blocks(Value begin, Value end, Value grain, const Body& body) {
  if (!(begin < end)) return;
  constexpr int workers = 3, rounds = 3;
  const Value count = static_cast<Value>(end - begin),
              block = std::max<Value>(grain, static_cast<Value>((count - 1) / (workers * rounds) + 1));
  if (inside_loop || count <= block) {
    body(begin, end);
    return;
  }
  std::atomic<bool> stop = false;
  std::mutex mutex;
  std::exception_ptr failed;
  const auto work = [&](int worker) {
    const bool outer = std::exchange(inside_loop, true);
    try {
      for (Value k = 0; k * block < count && !stop.load(std::memory_order_relaxed); ++k) {
        const Value first = static_cast<Value>(k * block);
        if (static_cast<int>(k % workers) == worker)
          body(static_cast<Value>(begin + first),
               static_cast<Value>(begin + first + std::min<Value>(block, count - first)));
      }
    } catch (...) {
      const std::scoped_lock lock(mutex);
      if (!failed) failed = std::current_exception();
      stop.store(true, std::memory_order_relaxed);
    }
    inside_loop = outer;
  };
  {
    std::array<std::jthread, workers - 1> threads;
    for (int k = 1; k < workers; ++k) threads[static_cast<std::size_t>(k - 1)] = std::jthread(work, k);
    work(0);
  }
  if (failed) std::rethrow_exception(failed);
}

template <class Value, class Body, class... Context>
requires std::is_integral_v<Value>
void parallel_for(Value begin, Value end, const Body& body, Context&&...) {
  for_blocks(begin, end, Value{1}, [&](Value first, Value last) {
    for (Value k = first; k < last; ++k) body(k);
  });
}

template <class Value, class Body, class... Way>
void parallel_for(const blocked_range<Value>& range, const Body& body, Way&&...) {
  for_blocks(range.begin(), range.end(), static_cast<Value>(range.grainsize()),
             [&](Value first, Value last) { body(blocked_range<Value>(first, last, range.grainsize())); });
}

}  // namespace tbb
