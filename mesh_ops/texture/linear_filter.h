#pragma once

#include <array>

#include "mesh_ops/texture/texel_rows.h"
#include "mesh_ops/texture/texels.h"

namespace rebake {

// Linear filtering by finer textures: every texel becomes factor × factor texels that hold the linearly filtered bytes
// at their centres, and all other code uses nearest sampling. With an odd factor the centre of each block is the
// texel's own centre, so the original bytes are kept there, and block_centers() undoes subdivided().
//
// Error of a byte against linear filtering: at most 1/2 by rounding, plus (|Δu| + |Δv|) / (2 · factor), where Δu and Δv
// are the differences to the neighbouring texels.

/// The stored bytes, feat0.R … feat1.A, under linear filtering with clamping at (u, v); v points up. `texels` reads a
/// texture of width × height texels.
std::array<double, 8> linear_bytes(const TexelReader& texels, int width, int height, double u, double v);

/// The texture with factor² texels per texel. A new texel is opaque if its filtered red byte is above 0; it is then at
/// least 1. Throws Error if a side would exceed 16384 texels, std::invalid_argument if the factor is even or below 3.
FeatureTexture subdivided(const FeatureTexture& texture, int factor);

/// The centres of blocks of factor × factor texels.
TexelRows block_centers(TexelRows fine, int factor);

/// Whether the texture equals the subdivided() centres of its blocks.
bool is_subdivided(const FeatureTexture& texture, int factor);

}  // namespace rebake
