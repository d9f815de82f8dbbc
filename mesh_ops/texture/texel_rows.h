#pragma once

#include <functional>
#include <memory>

#include "mesh_ops/texture/texels.h"

namespace rebake {

/// The texels of a texture as they are asked for, one row of tiles after the other: a large texture need not be in
/// memory to be written.
struct TexelRows {
  int width = 0, height = 0;
  /// Writes `count` rows of `width` texels from row `first` on. Callers ask for rows of tiles: `first` is a multiple of
  /// TexelTile::size and `count` at most that. Callable from several threads at once.
  std::function<void(int first, int count, Texel* rows)> read;
};

/// The texture's own texels, converted where `code` is another than its own (converted_texel).
TexelRows rows_of(std::shared_ptr<const FeatureTexture> texture, AlphaCode code);

/// The texel with its alpha stored another way. Halved from plain loses the alpha's lowest bit, as the published
/// exporter does.
Texel converted_texel(Texel texel, AlphaCode from, AlphaCode to);

}  // namespace rebake
