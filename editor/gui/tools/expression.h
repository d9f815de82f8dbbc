#pragma once

#include <optional>
#include <string_view>

namespace rebake {

/// The value of what people type into a number's field: numbers, + − * /, parentheses and pi, e.g. "90/4 + 1". Nothing
/// when it is no expression, or its value is not finite.
std::optional<double> evaluated(std::string_view text);

}  // namespace rebake
