#pragma once

#include <cstdint>
#include <string>

namespace rebake {

/// "1 triangle", "2 triangles". `many`: the plural; by default with an s.
inline std::string counted(std::uint64_t number, const std::string& one, const std::string& many = "") {
  return std::to_string(number) + " " + (number == 1 ? one : many.empty() ? one + "s" : many);
}

}  // namespace rebake
