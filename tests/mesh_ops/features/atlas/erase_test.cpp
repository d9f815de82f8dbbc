// The eraser clears the opacity of exactly the texels inside the region.
#include <gtest/gtest.h>

#include "mesh_ops/features/atlas/erase_texels.h"
#include "mesh_ops/index/footprint.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

TEST(Erase, ChangesOnlyOpacityInside) {
  const auto object = made_object({.columns = 64, .rows = 32});
  const auto inside = [](const Vec3& p) { return (p - Vec3(0, 0, 1)).norm() < 0.3; };
  const Erased result = erase_texels(*object, inside, [](const auto&) { return true; });
  EXPECT_GT(result.texels, 100U);
  const FeatureTexture &before = *object->sets[0].texels, &after = *result.sets[0].texels;
  std::vector<std::uint8_t> expected(static_cast<std::size_t>(before.width() * before.height()), 0);
  const TextureSet& set = object->sets[0];
  for (std::size_t f = 0; f < set.soup.triangle_count(); ++f) {
    const auto uv = texel_corners(set, f);
    for_each_texel_inside(uv, before.width(), before.height(), [&](int x, int y) {
      const Vec3 w = barycentric(uv, {x + 0.5, y + 0.5});
      Vec3 p = Vec3::Zero();
      for (std::size_t k = 0; k < 3; ++k) p += w[static_cast<int>(k)] * set.soup.positions()[set.soup.faces()[f][k]];
      if (inside(p)) expected[static_cast<std::size_t>(y * before.width() + x)] = 1;
    });
  }
  std::uint64_t cleared = 0;
  const TexelReader texels_before(before), texels_after(after);
  for (int y = 0; y < before.height(); ++y)
    for (int x = 0; x < before.width(); ++x) {
      Texel was = texels_before.at(x, y);
      const Texel& is = texels_after.at(x, y);
      if (expected[static_cast<std::size_t>(y * before.width() + x)] != 0) {
        EXPECT_FALSE(is.opaque()) << x << " " << y;
      }
      if (was.opaque() && !is.opaque()) {
        ++cleared;
        was.feat0[0] = 0;
      }
      ASSERT_EQ(was, is) << x << " " << y;
    }
  EXPECT_EQ(cleared, result.texels);
  EXPECT_EQ(after.opaque_count() + cleared, before.opaque_count());
}

TEST(Erase, KeepsTexelsOutsideTheTriangle) {
  // A triangle over one half of the texture: its bounding box also contains texels of the other half.
  auto object = std::make_shared<BakedObject>(*made_object({.columns = 4, .rows = 2}));
  TextureSet& set = object->sets[0];
  set.soup = Soup({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}, {Vec2(0, 1), Vec2(1, 1), Vec2(0, 0)}, {Face{0, 1, 2}});
  const Erased result = erase_texels(
      *object, [](const Vec3&) { return true; }, [](const auto&) { return true; });
  const FeatureTexture &before = *set.texels, &after = *result.sets[0].texels;
  const TexelReader texels_before(before), texels_after(after);
  for (int y = 0; y < before.height(); ++y)
    for (int x = 0; x < before.width(); ++x) {
      // Offset from the diagonal in texture coordinates; positive values are outside the triangle.
      const double beyond = static_cast<double>(x) / before.width() + static_cast<double>(y) / before.height() - 1;
      if (beyond > 0) {
        EXPECT_EQ(texels_before.at(x, y), texels_after.at(x, y)) << x << " " << y;
      }
    }
}

TEST(Erase, TilesWithoutAClearedTexelStayShared) {
  const auto object = made_object({.columns = 64, .rows = 32});
  const Erased result = erase_texels(
      *object, [](const Vec3& p) { return p.y() > 0.99; }, [](const auto&) { return true; });
  const FeatureTexture &before = *object->sets[0].texels, &after = *result.sets[0].texels;
  int shared = 0, copied = 0;
  for (int row = 0; row < before.tile_rows(); ++row)
    for (int column = 0; column < before.tile_columns(); ++column)
      ++(before.tile(column, row) == after.tile(column, row) ? shared : copied);
  EXPECT_GT(copied, 0);
  EXPECT_GT(shared, copied);
  const Erased nothing = erase_texels(
      *object, [](const Vec3&) { return false; }, [](const auto&) { return true; });
  EXPECT_EQ(nothing.texels, 0U);
  EXPECT_EQ(nothing.sets[0].texels, object->sets[0].texels);
}

}  // namespace
}  // namespace rebake::test
