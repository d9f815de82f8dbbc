// PNG files are byte-identical to those that OpenImageIO writes for the same pixels.
#include "mesh_ops/formats/images/png_writer.h"

#include <gtest/gtest.h>

#include <random>

#include "mesh_ops/base/files.h"
#include "tests/support/made_scenes.h"
#include "tests/support/picture_files.h"

namespace rebake::test {
namespace {

TEST(PngWriter, MatchesOpenImageIo) {
  const TemporaryFolder folder;
  for (const int channels : {3, 4}) {
    constexpr int width = 61, height = 37;
    std::mt19937 random(7);
    std::vector<std::uint8_t> bytes;
    std::vector<float> values;
    for (int k = 0; k < width * height * channels; ++k) {
      // Smooth rows, then noise. Opaque, so that nothing is multiplied by alpha.
      const bool alpha = channels == 4 && k % 4 == 3;
      bytes.push_back(alpha ? 255 : static_cast<std::uint8_t>(k / channels / width < 20 ? k / 50 : random()));
      values.push_back(static_cast<float>(bytes.back()) / 255);
    }
    write_picture(folder.path() / "other.png", {width, height, channels}, values);
    EXPECT_EQ(encode_png(width, height, channels, bytes, 6), read_file(folder.path() / "other.png")) << channels;
  }
}

TEST(PngWriter, RejectsMismatchedPixels) {
  const std::vector<std::uint8_t> bytes(12);
  EXPECT_THROW(encode_png(2, 3, 3, bytes, 6), std::invalid_argument);
  EXPECT_THROW(encode_png(0, 0, 3, {}, 6), std::invalid_argument);
  EXPECT_THROW(encode_png(2, 3, 2, bytes, 6), std::invalid_argument);
}

}  // namespace
}  // namespace rebake::test
