// Sums over objects that share data.
#include "mesh_ops/scene/object.h"

#include <gtest/gtest.h>

#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

TEST(SharedTotals, CountEachTextureAndArrayOnce) {
  const auto object = made_object();
  SharedTotals totals;
  totals.add(*object);
  EXPECT_EQ(totals.opaque_texels(), object->opaque_texel_count());
  EXPECT_EQ(totals.memory(), object->memory());
  // Other geometry with the same texture.
  BakedObject part = *object;
  const Soup& soup = object->sets[0].soup;
  std::vector<std::uint8_t> first(soup.triangle_count(), 0);
  first[0] = 1;
  part.sets[0].soup = subset(soup, first, 0, true);
  part.sets.resize(1);
  totals.add(part);
  totals.add(part);
  EXPECT_EQ(totals.opaque_texels(), object->opaque_texel_count());
  EXPECT_GT(totals.memory(), object->memory());
  EXPECT_LT(totals.memory(), object->memory() + part.memory());
  // An edited copy shares all tiles but one.
  BakedObject erased = *object;
  FeatureTexture::Change change(*object->sets[0].texels);
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) change.at(x, y) = empty_texel(object->sets[0].texels->alpha_code());
  erased.sets[0].texels = change.finish();
  totals.add(erased);
  EXPECT_GT(totals.opaque_texels(), object->opaque_texel_count());
  EXPECT_LT(totals.opaque_texels(), object->opaque_texel_count() + erased.opaque_texel_count());
  SharedTotals alone;
  alone.add(part);
  EXPECT_EQ(alone.memory(), part.memory());
}

}  // namespace
}  // namespace rebake::test
