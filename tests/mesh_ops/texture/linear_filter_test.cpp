// Linear filtering by finer textures, against the definition of OpenGL.
#include "mesh_ops/texture/linear_filter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "mesh_ops/base/error.h"

namespace rebake::test {
namespace {

FeatureTexture random_texture(int width, int height, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<Texel> texels(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (std::size_t k = 0; k < texels.size(); ++k) {
    for (std::size_t c = 0; c < 4; ++c) {
      texels[k].feat0[c] = static_cast<std::uint8_t>(random() % 256);
      texels[k].feat1[c] = static_cast<std::uint8_t>(random() % 256);
    }
    if (random() % 3 == 0) texels[k].feat0[0] = 0;
  }
  return FeatureTexture::from_rows(width, height, AlphaCode::plain, [&](int y, Texel* row) {
    std::copy_n(&texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width)], width, row);
  });
}

// OpenGL 4.5, section 8.14.3: the weighted sum over the texels around (u - 1/2, v - 1/2), v from the top here.
long double by_definition(const TexelReader& texels, int width, int height, long double u, long double v, int channel) {
  long double sum = 0;
  for (int y = -1; y <= height; ++y)
    for (int x = -1; x <= width; ++x) {
      const long double wx = 1 - std::abs(u * width - 0.5L - x), wy = 1 - std::abs(v * height - 0.5L - y);
      if (wx <= 0 || wy <= 0) continue;
      const Texel& texel = texels.at(std::clamp(x, 0, width - 1), std::clamp(y, 0, height - 1));
      sum += wx * wy *
             static_cast<std::size_t>(channel < 4 ? texel.feat0.at(static_cast<std::size_t>(channel))
                                                  : texel.feat1.at(static_cast<std::size_t>(channel - 4)));
    }
  return sum;
}

TEST(LinearFilter, BytesMatchTheDefinition) {
  const FeatureTexture texture = random_texture(13, 7, 1);
  const TexelReader texels(texture);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int k = 0; k < 2000; ++k) {
    const double u = k < 4 ? k % 2 : unit(random), v = k < 4 ? k / 2 : unit(random);
    const std::array<double, 8> bytes = linear_bytes(texels, 13, 7, u, v);
    for (int c = 0; c < 8; ++c)
      ASSERT_NEAR(bytes[static_cast<std::size_t>(c)],
                  static_cast<double>(by_definition(texels, 13, 7, u, 1 - static_cast<long double>(v), c)), 1e-11);
  }
}

TEST(LinearFilter, FinerTexelsHoldTheFilteredBytes) {
  for (const int factor : {3, 5, 9}) {
    const FeatureTexture texture = random_texture(40, 31, 3), fine = subdivided(texture, factor);
    const TexelReader texels(texture), is(fine);
    ASSERT_EQ(fine.width(), 40 * factor);
    for (int y = 0; y < fine.height(); ++y)
      for (int x = 0; x < fine.width(); ++x) {
        const std::array<double, 8> bytes =
            linear_bytes(texels, 40, 31, (x + 0.5) / fine.width(), 1 - (y + 0.5) / fine.height());
        ASSERT_EQ(is.at(x, y).opaque(), bytes[0] > 1e-9) << x << " " << y;
        for (std::size_t c = 1; c < 4; ++c) {
          ASSERT_LE(std::abs(is.at(x, y).feat0[c] - bytes[c]), 0.5 + 1e-9);
          ASSERT_LE(std::abs(is.at(x, y).feat1[c] - bytes[c + 4]), 0.5 + 1e-9);
        }
      }
  }
}

TEST(LinearFilter, CentersAreTheTexels) {
  // Wider than a tile, so that rows of tiles are crossed.
  const auto texture = std::make_shared<const FeatureTexture>(random_texture(130, 300, 4));
  for (const int factor : {3, 7}) {
    const auto fine = std::make_shared<const FeatureTexture>(subdivided(*texture, factor));
    EXPECT_TRUE(is_subdivided(*fine, factor));
    const TexelRows centers = block_centers(rows_of(fine, AlphaCode::plain), factor);
    const FeatureTexture back =
        FeatureTexture::from_parts(centers.width, centers.height, AlphaCode::plain, centers.read);
    const TexelReader a(*texture), b(back);
    for (int y = 0; y < texture->height(); ++y)
      for (int x = 0; x < texture->width(); ++x) ASSERT_EQ(a.at(x, y), b.at(x, y));
    FeatureTexture::Change change(*fine);
    change.at(fine->width() - 1, fine->height() - 1).feat1[3] ^= 1;
    EXPECT_FALSE(is_subdivided(*change.finish(), factor));
    EXPECT_FALSE(is_subdivided(*texture, factor)) << "its size is no multiple";
  }
}

// The bound of linear_filter.h, at random points.
TEST(LinearFilter, ErrorStaysWithinItsBound) {
  const FeatureTexture texture = random_texture(40, 31, 5);
  const TexelReader texels(texture);
  std::mt19937 random(6);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const int factor : {3, 5, 9}) {
    const FeatureTexture fine = subdivided(texture, factor);
    const TexelReader is(fine);
    double largest = 0;
    for (int k = 0; k < 5000; ++k) {
      const double u = unit(random), v = unit(random);
      const std::array<double, 8> bytes = linear_bytes(texels, 40, 31, u, v);
      const Texel& texel = is.sample(u, v);
      for (std::size_t c = 1; c < 4; ++c) largest = std::max(largest, std::abs(texel.feat0[c] - bytes[c]));
    }
    // Neighbours differ by at most 255 in each direction.
    EXPECT_LE(largest, 0.5 + 255.0 / factor);
    EXPECT_GT(largest, 0.25 * 255 / factor) << "the bound is not far above the error";
  }
}

TEST(LinearFilter, RejectsOtherFactorsAndTexturesThatBecomeTooLarge) {
  const FeatureTexture texture = random_texture(4, 4, 1);
  for (const int factor : {-3, 0, 1, 2, 4}) EXPECT_THROW(subdivided(texture, factor), std::invalid_argument);
  const FeatureTexture wide =
      FeatureTexture::from_rows(6000, 1, AlphaCode::plain, [](int, Texel* row) { std::fill_n(row, 6000, Texel{}); });
  EXPECT_THROW(subdivided(wide, 3), Error);
}

}  // namespace
}  // namespace rebake::test
