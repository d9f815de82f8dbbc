#include "mesh_ops/texture/texel_rows.h"

#include <algorithm>
#include <utility>

namespace rebake {

Texel converted_texel(Texel texel, AlphaCode from, AlphaCode to) {
  if (from == to) return texel;
  for (std::uint8_t* alpha : {&texel.feat0[3], &texel.feat1[3]}) {
    if (to == AlphaCode::halved)
      *alpha = static_cast<std::uint8_t>(*alpha / 2 + 128);
    else if (!texel.opaque())
      *alpha = 0;
    else
      *alpha = static_cast<std::uint8_t>(std::max(0, 2 * *alpha - 255));  // exactly the decoded value
  }
  return texel;
}

TexelRows rows_of(std::shared_ptr<const FeatureTexture> texture, AlphaCode code) {
  const int width = texture->width(), height = texture->height();
  return {width, height, [texture = std::move(texture), code, width](int first, int count, Texel* rows) {
            for (int column = 0; column < texture->tile_columns(); ++column) {
              const auto tile = texture->tile(column, first / TexelTile::size)->texels();
              const int left = column * TexelTile::size, columns = std::min(TexelTile::size, width - left);
              for (int y = 0; y < count; ++y)
                std::transform(tile->begin() + y * TexelTile::size, tile->begin() + y * TexelTile::size + columns,
                               rows + static_cast<std::ptrdiff_t>(y) * width + left,
                               [&](const Texel& texel) { return converted_texel(texel, texture->alpha_code(), code); });
            }
          }};
}

}  // namespace rebake
