#pragma once

#include <algorithm>

namespace tbb {

/// Sorts on one thread; see parallel_for.h in this folder.
template <class Container>
void parallel_sort(Container& values) {
  std::ranges::sort(values);
}

}  // namespace tbb
