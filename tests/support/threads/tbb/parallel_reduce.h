#pragma once

#include <tbb/parallel_for.h>

namespace tbb {

/// See tbb/parallel_for.h beside this.
template <class Range, class Value, class Body, class Join>
Value parallel_reduce(const Range& range, const Value& identity, const Body& body, const Join& join) {
  std::mutex mutex;
  Value result = identity;
  parallel_for(range, [&](const Range& part) {
    const Value found = body(part, identity);
    const std::scoped_lock lock(mutex);
    result = join(result, found);
  });
  return result;
}

}  // namespace tbb
