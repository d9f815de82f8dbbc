#pragma once

#include <cstddef>
#include <cstdint>

namespace rebake {

/// Rows that undo_png_filters takes at once.
constexpr int png_filter_rows = 4;

/// Undoes the filters of `count` rows of a PNG of 8-bit RGBA (PNG specification, third edition, section 9): rows of
/// 1 + 4·`width` bytes, of which the first names the filter; pixels are replaced. `above` are the 4·`width` bytes of
/// the row before the first, zeros where there is none. Behind the rows there must be room for png_filter_rows − 1
/// more, which is overwritten. Filters above 4 are no filters of PNG: see first_unknown_png_filter.
void undo_png_filters(std::uint8_t* rows, int count, int width, const std::uint8_t* above);

/// The first of `count` rows of `stride` bytes that begins with no filter of PNG; `count` where all do.
int first_unknown_png_filter(const std::uint8_t* rows, int count, std::size_t stride);

}  // namespace rebake
