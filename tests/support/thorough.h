#pragma once

#include <cstdlib>

namespace rebake::test {

/// Whether tests run at full size: the environment sets REBAKE_DEEP, as .ci/deep does.
inline const bool is_deep = std::getenv("REBAKE_DEEP") != nullptr;

/// The number of cases that a property test tries.
inline int cases(int quick, int deep) { return is_deep ? deep : quick; }

/// The same, with a number of its own for sanitizers: they are up to 150 times slower, and need only reach all code.
#ifdef REBAKE_SANITIZED
inline constexpr bool is_sanitized = true;
#else
inline constexpr bool is_sanitized = false;
#endif
inline int cases(int quick, int deep, int sanitized) { return is_sanitized ? sanitized : cases(quick, deep); }

/// Factor for the number of cases in tests with very many cases.
inline const int thorough = cases(2, 8, 1);

}  // namespace rebake::test

/// Skips a test that takes minutes unless REBAKE_DEEP is set; tests/expected_skips lists these tests with their
/// reasons.
#define REBAKE_ONLY_DEEP() \
  if (!rebake::test::is_deep) GTEST_SKIP() << "runs in .ci/deep"
