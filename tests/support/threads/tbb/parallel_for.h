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

/// What the thread sanitizer's build takes for TBB's loops. The library is not built with the sanitizer, which hence
/// takes all that TBB orders for races; threads of the standard library it knows. Loops within loops run in order; what
/// contexts do when a loop is stopped is not imitated.
namespace tbb {

/// Of this thread: it carries out a block.
inline thread_local bool inside_loop = false;

/// `body(begin, end)` on blocks of at least `grain`, dealt out to three threads in turn: nothing but their beginning
/// and end puts them in order, so that what they share is found whichever runs first. What the first to fail throws is
/// thrown, and what has not begun by then is left out.
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
