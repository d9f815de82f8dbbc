#pragma once

#include <functional>
#include <memory>

#include "mesh_ops/texture/texels.h"

namespace rebake {

/// Texels of a texture, produced on request for one row of tiles at a time, so that a large texture can be written
/// without being in memory as a whole.
struct TexelRows {
  int width = 0, height = 0;
  /// Writes `count` rows of `width` texels, from row `first` on, to `rows`. `first` must be a multiple of
  /// TexelTile::size, and `count` at most TexelTile::size. Thread-safe.
  std::function<void(int first, int count, Texel* rows)> read;
};

/// Rows of a texture, converted by converted_texel() to `code`.
TexelRows rows_of(std::shared_ptr<const FeatureTexture> texture, AlphaCode code);

/// Converts the code of a texel's alpha channels. From plain to halved, alpha loses its lowest bit, as in the published
/// exporter.
Texel converted_texel(Texel texel, AlphaCode from, AlphaCode to);

}  // namespace rebake
