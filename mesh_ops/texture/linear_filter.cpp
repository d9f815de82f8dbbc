#include "mesh_ops/texture/linear_filter.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "mesh_ops/base/error.h"

namespace rebake {

namespace {

constexpr int longest_side = 16384;

// The two texels around a coordinate in texels, clamped, and the weight of the second.
struct Between {
  int first, second;
  double weight;
};
Between between(double coordinate, int size) {
  const double at = std::clamp(coordinate - 0.5, -1.0, static_cast<double>(size));
  const double below = std::floor(at);
  const int first = static_cast<int>(below);
  return {std::clamp(first, 0, size - 1), std::clamp(first + 1, 0, size - 1), at - below};
}

const std::uint8_t& byte_of(const Texel& texel, std::size_t k) { return k < 4 ? texel.feat0[k] : texel.feat1[k - 4]; }

std::array<double, 8> blend(const Texel& a, const Texel& b, const Texel& c, const Texel& d, double right, double down) {
  std::array<double, 8> bytes{};
  for (std::size_t k = 0; k < 8; ++k)
    bytes[k] =
        std::lerp(std::lerp(byte_of(a, k), byte_of(b, k), right), std::lerp(byte_of(c, k), byte_of(d, k), right), down);
  return bytes;
}

Texel rounded(const std::array<double, 8>& bytes) {
  Texel texel{};
  for (std::size_t k = 0; k < 8; ++k)
    (k < 4 ? texel.feat0[k] : texel.feat1[k - 4]) = static_cast<std::uint8_t>(std::lround(bytes[k]));
  if (bytes[0] > 0) texel.feat0[0] = std::max<std::uint8_t>(texel.feat0[0], 1);
  return texel;
}

void fill_row(const TexelReader& texels, int width, int height, int factor, int y, Texel* row) {
  const Between vertical = between((y + 0.5) / factor, height);
  for (int x = 0; x < width * factor; ++x) {
    const Between horizontal = between((x + 0.5) / factor, width);
    row[x] = rounded(blend(texels.at(horizontal.first, vertical.first), texels.at(horizontal.second, vertical.first),
                           texels.at(horizontal.first, vertical.second), texels.at(horizontal.second, vertical.second),
                           horizontal.weight, vertical.weight));
    // Without a rounding of (x + 0.5) / factor.
    if (x % factor == factor / 2 && y % factor == factor / 2) row[x] = texels.at(x / factor, y / factor);
  }
}

}  // namespace

std::array<double, 8> linear_bytes(const TexelReader& texels, int width, int height, double u, double v) {
  const Between horizontal = between(u * width, width), vertical = between((1 - v) * height, height);
  return blend(texels.at(horizontal.first, vertical.first), texels.at(horizontal.second, vertical.first),
               texels.at(horizontal.first, vertical.second), texels.at(horizontal.second, vertical.second),
               horizontal.weight, vertical.weight);
}

FeatureTexture subdivided(const FeatureTexture& texture, int factor) {
  if (factor < 3 || factor % 2 == 0) throw std::invalid_argument("the factor of a subdivided texture must be odd");
  const int width = texture.width(), height = texture.height();
  if (std::max(width, height) > longest_side / factor)
    throw Error(fmt::format("textures of {}×{} texels, {} times as fine, exceed {} texels: use a smaller factor", width,
                            height, factor, longest_side));
  const TexelReader texels(texture);
  return FeatureTexture::from_parts(
      width * factor, height * factor, texture.alpha_code(), [&](int first, int count, Texel* rows) {
        tbb::parallel_for(0, count, [&](int y) {
          fill_row(texels, width, height, factor, first + y, rows + static_cast<std::ptrdiff_t>(y) * width * factor);
        });
      });
}

TexelRows block_centers(TexelRows fine, int factor) {
  const int width = fine.width / factor, height = fine.height / factor;
  return {width, height, [fine = std::move(fine), factor, width](int first, int count, Texel* rows) {
            const auto fine_width = static_cast<std::size_t>(fine.width);
            std::vector<Texel> part(fine_width * TexelTile::size);
            int loaded = -1;  // first row of `part`
            for (int y = 0; y < count; ++y) {
              const int at = (first + y) * factor + factor / 2, tile = at - at % TexelTile::size;
              if (tile != loaded) fine.read(tile, std::min(TexelTile::size, fine.height - tile), part.data());
              loaded = tile;
              const Texel* row = &part[static_cast<std::size_t>(at - tile) * fine_width];
              for (int x = 0; x < width; ++x)
                rows[static_cast<std::ptrdiff_t>(y) * width + x] = row[x * factor + factor / 2];
            }
          }};
}

bool is_subdivided(const FeatureTexture& texture, int factor) {
  if (texture.width() % factor != 0 || texture.height() % factor != 0) return false;
  const std::shared_ptr<const FeatureTexture> borrowed(std::shared_ptr<const void>(), &texture);
  const TexelRows centers = block_centers(rows_of(borrowed, texture.alpha_code()), factor);
  const FeatureTexture coarse =
      FeatureTexture::from_parts(centers.width, centers.height, texture.alpha_code(), centers.read);
  const TexelReader is(texture), should(coarse);
  std::atomic<bool> same = true;
  tbb::parallel_for(0, texture.height(), [&](int y) {
    if (!same) return;
    std::vector<Texel> row(static_cast<std::size_t>(texture.width()));
    fill_row(should, coarse.width(), coarse.height(), factor, y, row.data());
    for (int x = 0; x < texture.width(); ++x)
      if (!(is.at(x, y) == row[static_cast<std::size_t>(x)])) same = false;
  });
  return same;
}

}  // namespace rebake
