#pragma once

#include "mesh_ops/scene/object.h"
#include "mesh_ops/texture/texel_rows.h"

namespace rebake {

// Conversion between the published format and dialects of it (struct Dialect).

/// The decoder of a file as the published format has it: takes the direction after the features, with length 1. Exact
/// up to the rounding of the first biases.
Decoder from_dialect(const Decoder& decoder, const Dialect& dialect);
/// The inverse of from_dialect().
Decoder to_dialect(const Decoder& decoder, const Dialect& dialect);

/// The alpha code of a folder's textures.
AlphaCode alpha_code_of(Layout layout, const Dialect& dialect);

/// Texels in the channel order of the dialect, and back: swaps red and blue of both images for BGR.
void swap_channels(const Dialect& dialect, int count, Texel* texels);
/// Makes transparent texels opaque if the dialect has no holes. Returns their number.
std::size_t fill_holes(const Dialect& dialect, int count, Texel* texels);
TexelRows in_channel_order(TexelRows rows, const Dialect& dialect);

}  // namespace rebake
