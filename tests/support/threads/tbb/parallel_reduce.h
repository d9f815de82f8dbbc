#pragma once

#include <tbb/parallel_for.h>

#include <map>

namespace tbb {

/// See parallel_for.h in this folder. Partial results are joined in order.
template <class Range, class Value, class Body, class Join>
Value parallel_reduce(const Range& range, const Value& identity, const Body& body, const Join& join) {
  std::mutex mutex;
  std::map<typename Range::const_iterator, Value> parts;
  parallel_for(range, [&](const Range& part) {
    const Value found = body(part, identity);
    const std::scoped_lock lock(mutex);
    parts.emplace(part.begin(), found);
  });
  Value result = identity;
  for (const auto& [begin, value] : parts) result = join(result, value);
  return result;
}

}  // namespace tbb
