#pragma once

#include <cstdlib>

namespace rebake::test {

/// Whether tests run at full size: when the environment sets REBAKE_DEEP, as .ci/deep does.
inline const bool is_deep = std::getenv("REBAKE_DEEP") != nullptr;

/// The number of cases that a property test tries.
inline int cases(int quick, int deep) { return is_deep ? deep : quick; }

/// How many times more cases tests with very many of them try than they need to reach all of the code. Sanitizers,
/// which look at memory and not at results, get by with few: they are up to 150 times slower.
#ifdef REBAKE_SANITIZED
inline constexpr int thorough = 1;
#else
inline const int thorough = cases(2, 8);
#endif

}  // namespace rebake::test

/// Leaves a test that takes minutes to .ci/deep; tests/expected_skips lists each with its reason.
#define REBAKE_ONLY_DEEP() \
  if (!rebake::test::is_deep) GTEST_SKIP() << "runs in .ci/deep"
