#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <string>

namespace rebake {

/// What stands between the name of some work and how long it will take, in what it reports as progress.
inline constexpr const char* about = ", about ";

/// "40 s", "3 min" or "2 h": a time that is estimated.
inline std::string duration_text(double seconds) {
  if (seconds < 90) return fmt::format("{:.0f} s", std::max(1.0, seconds));
  if (seconds < 5400) return fmt::format("{:.0f} min", seconds / 60);
  return fmt::format("{:.1f} h", seconds / 3600);
}

}  // namespace rebake
