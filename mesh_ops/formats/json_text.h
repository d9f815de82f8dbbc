#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>

namespace rebake {

/// The members of the JSON object that `text` holds: key → value, spelt as in the text. Empty for text that is not an
/// object. `text` must be valid JSON.
std::map<std::string, std::string> json_members(std::string_view text);

/// Where a byte of a JSON text lies: "\"0_weights\"[3][2]", counted from 0; empty for outside any member. Works up to
/// the byte even if the text is not valid behind it.
std::string json_place(std::string_view text, std::size_t byte);

}  // namespace rebake
