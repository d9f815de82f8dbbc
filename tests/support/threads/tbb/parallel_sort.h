#pragma once

#include <algorithm>

namespace tbb {

/// See tbb/parallel_for.h beside this: here one thread sorts.
template <class Container>
void parallel_sort(Container& values) {
  std::ranges::sort(values);
}

}  // namespace tbb
