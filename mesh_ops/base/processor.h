#pragma once

#include <cstdlib>

namespace rebake {

#ifdef REBAKE_WIDE_VECTORS
// Micro-architecture levels of the x86-64 psABI. Features that are not tested come with those that are.

/// Highest level to use: the environment variable REBAKE_VECTORS (1, 3 or 4), so that one machine can check the results
/// of others. Default: 4.
inline int allowed_level() {
  const char* const said = std::getenv("REBAKE_VECTORS");
  return said == nullptr || *said == 0 ? 4 : std::atoi(said);
}
inline bool processor_has_v3() {
  return allowed_level() >= 3 && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
         __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
}
inline bool processor_has_v4() {
  return allowed_level() >= 4 && processor_has_v3() && __builtin_cpu_supports("avx512f") &&
         __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512cd") &&
         __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
}
#endif

}  // namespace rebake
