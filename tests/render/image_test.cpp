// Reading pictures keeps the stored colours and drops alpha.
#include "render/image.h"

#include <gtest/gtest.h>

#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/images/png_writer.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

TEST(Image, RoundTrip) {
  const TemporaryFolder folder;
  Image image{3, 2, {}};
  for (int k = 0; k < 18; ++k) image.rgb.push_back(static_cast<std::uint8_t>(k * 14));
  write_png(image, folder.path() / "a.png", {});
  EXPECT_EQ(read_image(folder.path() / "a.png"), image);
}

TEST(Image, DropsAlpha) {
  const TemporaryFolder folder;
  write_text(folder.path() / "a.png",
             encode_png(2, 1, 4, std::vector<std::uint8_t>{200, 100, 50, 128, 255, 1, 2, 0}, 6));
  EXPECT_EQ(read_image(folder.path() / "a.png"), (Image{2, 1, {200, 100, 50, 255, 1, 2}}));
}

}  // namespace
}  // namespace rebake::test
