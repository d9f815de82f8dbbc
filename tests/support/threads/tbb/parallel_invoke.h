#pragma once

#include <tbb/parallel_for.h>

namespace tbb {

/// See parallel_for.h in this folder.
template <class First, class Second, class... Context>
void parallel_invoke(const First& first, const Second& second, Context&&...) {
  parallel_for(0, 2, [&](int which) { which == 0 ? first() : second(); });
}

}  // namespace tbb
