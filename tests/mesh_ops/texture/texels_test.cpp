// Packed textures are lossless and can be read by many threads; opacity is known without unpacking.
#include "mesh_ops/texture/texels.h"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <random>

namespace rebake::test {
namespace {

constexpr int columns = 760, rows = 530;  // whole tiles and partial tiles

// Empty on the left, smooth in the middle, incompressible noise on the right.
std::vector<Texel> picture() {
  std::mt19937 random(5);
  std::vector<Texel> texels(static_cast<std::size_t>(columns) * rows, empty_texel(AlphaCode::halved));
  for (int y = 0; y < rows; ++y)
    for (int x = 256; x < columns; ++x) {
      Texel& texel = texels[static_cast<std::size_t>(y) * columns + static_cast<std::size_t>(x)];
      const bool smooth = x < 512;
      for (std::size_t k = 0; k < 4; ++k) {
        texel.feat0[k] = static_cast<std::uint8_t>(smooth ? (x / 20 + y / 30) * (k + 1) : random());
        texel.feat1[k] = static_cast<std::uint8_t>(smooth ? y / 17 : random());
      }
      if ((x + y) % 9 == 0) texel.feat0[0] = 0;
    }
  return texels;
}

FeatureTexture read_texture(const std::vector<Texel>& texels) {
  return FeatureTexture::from_parts(columns, rows, AlphaCode::halved, [&](int y, int count, Texel* filled) {
    std::copy_n(texels.begin() + static_cast<std::ptrdiff_t>(y) * columns, static_cast<std::ptrdiff_t>(count) * columns,
                filled);
  });
}

TEST(Texels, ArePackedWithoutLoss) {
  const std::vector<Texel> expected = picture();
  const FeatureTexture texture = read_texture(expected);
  std::atomic<int> wrong = 0;
  const TexelReader shared(texture);
  tbb::parallel_for(0, rows, [&](int y) {
    for (int x = 0; x < columns; ++x) {
      const Texel& texel = expected[static_cast<std::size_t>(y) * columns + static_cast<std::size_t>(x)];
      if (!(shared.at(x, y) == texel) || texture.opaque(x, y) != texel.opaque()) ++wrong;
    }
  });
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(texture.opaque_count(),
            std::count_if(expected.begin(), expected.end(), [](const Texel& texel) { return texel.opaque(); }));
  for (const double u : {-0.5, 0.0, 0.3, 0.7, 1.0, 1.5})
    for (const double v : {-3.0, 0.0, 0.4, 0.9999, 1.0, 7.0})
      EXPECT_EQ(texture.opaque_at(u, v), shared.sample(u, v).opaque()) << u << " " << v;
}

TEST(Texels, IncompressibleTilesStayUnpacked) {
  const FeatureTexture texture = read_texture(picture());
  constexpr std::uint64_t tile = TexelTile::size * TexelTile::size * sizeof(Texel), flags = tile / 64;
  EXPECT_EQ(texture.tile(0, 0), texture.tile(0, 1)) << "empty tiles must be shared";
  EXPECT_LT(texture.tile(1, 0)->memory(), tile / 4);
  EXPECT_EQ(texture.tile(2, 0)->memory(), tile + flags);
}

// Edits copy the tiles that they touch, and no others.
TEST(Texels, ChangesCopyOnlyTheirTiles) {
  const std::vector<Texel> expected = picture();
  const FeatureTexture texture = read_texture(expected);
  FeatureTexture::Change change(texture);
  EXPECT_FALSE(change.touched());
  const int x = 300, y = 20;
  change.at(x, y).feat0 = {0, 7, 7, 7};
  ASSERT_TRUE(change.touched());
  const auto changed = change.finish();
  EXPECT_FALSE(changed->opaque(x, y));
  EXPECT_TRUE(texture.opaque(x, y));
  const TexelReader before(texture), after(*changed);
  int differ = 0;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) differ += before.at(column, row) == after.at(column, row) ? 0 : 1;
  EXPECT_EQ(differ, 1);
  for (int row = 0; row < texture.tile_rows(); ++row)
    for (int column = 0; column < texture.tile_columns(); ++column)
      EXPECT_EQ(texture.tile(column, row) == changed->tile(column, row), column != 1 || row != 0);
  EXPECT_TRUE(texture.tile(1, 0)->more_opaque_than(*changed->tile(1, 0)));
  EXPECT_FALSE(changed->tile(1, 0)->more_opaque_than(*texture.tile(1, 0)));
}

}  // namespace
}  // namespace rebake::test
