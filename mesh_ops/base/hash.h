#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace rebake {

/// XXH64, seed 0: what files and journals are checked by.
std::uint64_t content_hash(std::string_view bytes);

/// As 16 hexadecimal digits.
std::string hash_text(std::uint64_t hash);

}  // namespace rebake
