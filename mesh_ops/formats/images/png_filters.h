#pragma once

#include <cstddef>
#include <cstdint>

namespace rebake {

/// Number of rows that undo_png_filters() processes together.
constexpr int png_filter_rows = 4;

/// Reverses the filters of `count` rows of an 8-bit RGBA PNG in place (PNG specification, third edition, section 9). A
/// row has 1 + 4·`width` bytes, the first of which is the filter type. `above`: the 4·`width` bytes of the row before
/// the first, or zeros. The buffer needs space for png_filter_rows − 1 more rows, which are overwritten. Filter types
/// above 4 are invalid; see first_unknown_png_filter().
void undo_png_filters(std::uint8_t* rows, int count, int width, const std::uint8_t* above);

/// Number of the first row with an invalid filter type, among `count` rows of `stride` bytes; `count` if all are valid.
int first_unknown_png_filter(const std::uint8_t* rows, int count, std::size_t stride);

}  // namespace rebake
