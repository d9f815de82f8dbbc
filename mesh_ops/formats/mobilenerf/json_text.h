#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>

namespace rebake {

/// Members of the JSON object in `text`: key → value, both as spelt. Empty for text that is not an object. `text` must
/// be valid JSON.
std::map<std::string, std::string> json_members(std::string_view text);

/// Path to a byte of a JSON text, such as `"0_weights"[3][2]` (indices from 0); empty outside all members. The text
/// need not be valid after that byte.
std::string json_path(std::string_view text, std::size_t byte);

}  // namespace rebake
