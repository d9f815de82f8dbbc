#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>

namespace rebake {

/// Members of the JSON object in `text`: key → value, both as spelt. Empty for text that is not an object. `text` must
/// be valid JSON.
std::map<std::string, std::string> json_members(std::string_view text);

/// A JSON text without commas after the last elements of arrays and objects.
struct TrimmedJson {
  std::string text;            ///< blanks replace the commas, so that places stay the same
  std::size_t commas = 0;      ///< number of removed commas
  std::size_t first_line = 0;  ///< of the first one, from 1
};
TrimmedJson without_trailing_commas(std::string_view text);

/// Path to a byte of a JSON text, such as `"0_weights"[3][2]` (indices from 0); empty outside all members. The text
/// need not be valid after that byte.
std::string json_path(std::string_view text, std::size_t byte);

}  // namespace rebake
