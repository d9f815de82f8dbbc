#pragma once

namespace rebake::test {

/// How many times more cases tests with very many of them try than they need to reach all of the code. Sanitizers,
/// which look at memory and not at results, get by with few: they are up to 150 times slower.
#ifdef REBAKE_SANITIZED
inline constexpr int thorough = 1;
#else
inline constexpr int thorough = 8;
#endif

}  // namespace rebake::test
