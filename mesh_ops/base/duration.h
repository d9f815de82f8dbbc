#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>

namespace rebake {

/// Separator between the name of a task and its estimated duration in progress messages.
inline constexpr const char* about = ", about ";

/// Seconds of wall clock since a moment.
inline double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// An estimated duration as text: "40 s", "3 min" or "2.0 h".
inline std::string duration_text(double seconds) {
  if (seconds < 90) return fmt::format("{:.0f} s", std::max(1.0, seconds));
  if (seconds < 5400) return fmt::format("{:.0f} min", seconds / 60);
  return fmt::format("{:.1f} h", seconds / 3600);
}

/// As duration_text(), in steps of half a minute below a minute and a half, for progress: logs show each text once.
inline std::string remaining_text(double seconds) {
  constexpr double step = 30;
  return duration_text(seconds < 90 ? std::ceil(seconds / step) * step : seconds);
}

}  // namespace rebake
