#pragma once

#include <optional>
#include <string_view>

namespace rebake {

/// Evaluates an arithmetic expression of numbers, + − * /, parentheses and pi, e.g. "90/4 + 1". Returns nothing for a
/// syntax error or a value that is not finite.
std::optional<double> evaluated(std::string_view text);

}  // namespace rebake
