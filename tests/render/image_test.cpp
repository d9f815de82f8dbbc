// Pictures keep their colours when they are written and read; reading drops alpha.
#include "render/image.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/images/picture_codecs.h"
#include "mesh_ops/formats/images/png_writer.h"
#include "mesh_ops/scene/scene_light.h"
#include "render/compare.h"
#include "render/picture_mark.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

TEST(Image, RoundTrip) {
  const TemporaryFolder folder;
  Image image{3, 2, {}};
  for (int k = 0; k < 18; ++k) image.rgb.push_back(static_cast<std::uint8_t>(k * 14));
  write_picture(image, folder.path() / "a.png", {});
  EXPECT_EQ(read_image(folder.path() / "a.png"), image);
}

Image colorful() {
  Image image{64, 48, {}};
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (const int value : {x * 4, y * 5, 255 - x * 2 - y}) image.rgb.push_back(static_cast<std::uint8_t>(value));
  return image;
}

TEST(Image, LosslessFormatsKeepEveryByte) {
  const TemporaryFolder folder;
  for (const char* name : {"a.png", "a.webp", "a.WEBP", "unknown.format", "none"}) {
    write_picture(colorful(), folder.path() / name, {});
    EXPECT_EQ(read_image(folder.path() / name), colorful()) << name;
  }
}

TEST(Image, ExtensionsDecideTheFormat) {
  const TemporaryFolder folder;
  for (const auto& [name, start] : std::map<std::string, std::string>{
           {"a.png", "\x89PNG"}, {"a.jpg", "\xff\xd8\xff"}, {"a.webp", "RIFF"}, {"a.exr", "\x76\x2f\x31\x01"}}) {
    write_picture(colorful(), folder.path() / name, {});
    EXPECT_TRUE(read_file(folder.path() / name).starts_with(start)) << name;
  }
}

TEST(Image, RecognisesWhatItWroteAndWritesTheSameBytes) {
  const TemporaryFolder folder;
  Image transparent = colorful();
  transparent.alpha.assign(transparent.rgb.size() / 3, 128);
  for (const char* extension : {".png", ".jpg", ".webp", ".exr"})
    for (const Image& image : {colorful(), transparent}) {
      const auto path = folder.path() / (std::string("a") + extension);
      write_picture(image, path, {});
      EXPECT_TRUE(is_rendered_picture(path)) << extension;
      const std::string bytes = read_file(path);
      write_picture(image, path, {});
      EXPECT_EQ(read_file(path), bytes) << extension;
    }
  write_file_atomically(folder.path() / "foreign.webp", "RIFF\x04\0\0\0WEBP", {});
  EXPECT_FALSE(is_rendered_picture(folder.path() / "foreign.webp"));
}

// Retouched pictures are somebody's work, also if a program keeps the metadata.
TEST(Image, DoesNotRecogniseWhatSomeoneChanged) {
  const TemporaryFolder folder;
  for (const char* extension : {".png", ".jpg", ".webp", ".exr"}) {
    const auto path = folder.path() / (std::string("a") + extension);
    write_picture(colorful(), path, {});
    const std::string bytes = read_file(path);
    for (std::size_t at = 4; at < bytes.size(); at += 1 + bytes.size() / 300) {
      std::string changed = bytes;
      changed[at] = static_cast<char>(changed[at] ^ 1);
      write_text(path, changed);
      EXPECT_FALSE(is_rendered_picture(path)) << extension << " at " << at;
    }
    write_text(path, bytes + "more");
    EXPECT_FALSE(is_rendered_picture(path)) << extension;
    for (std::size_t size = 0; size < bytes.size(); size += size < 200 ? 1 : bytes.size() / 30) {
      write_text(path, bytes.substr(0, size));
      EXPECT_FALSE(is_rendered_picture(path)) << extension << " of " << size;
    }
    write_text(path, bytes);
    EXPECT_TRUE(is_rendered_picture(path)) << extension;
  }
}

TEST(Image, PlotsGetTheMarkToo) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "plot.svg";
  const std::string plot = "<?xml version=\"1.0\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\"/>\n";
  write_text(path, plot);
  EXPECT_FALSE(is_rendered_picture(path));
  const std::string marked = with_mark(plot + std::string(100'000, '\n'));
  write_text(path, marked);
  EXPECT_TRUE(is_rendered_picture(path));
  for (const std::string& changed : {marked + "\n", "<?xml?>" + marked, marked.substr(0, marked.size() - 1)}) {
    write_text(path, changed);
    EXPECT_FALSE(is_rendered_picture(path));
  }
}

TEST(Image, JpegsAreCloseToTheOriginal) {
  const TemporaryFolder folder;
  write_picture(colorful(), folder.path() / "a.jpg", {});
  EXPECT_GT(compare(read_image(folder.path() / "a.jpg"), colorful(), 2).psnr_db, 45);
}

TEST(Image, OpenExrHoldsLinearLight) {
  const TemporaryFolder folder;
  const Image image = colorful();
  write_picture(image, folder.path() / "a.exr", {});
  const Image back = read_image(folder.path() / "a.exr");
  for (std::size_t k = 0; k < image.rgb.size(); ++k)
    EXPECT_NEAR(back.rgb[k], image.rgb[k], 1) << "display colours again";
  const auto reader = open_picture(folder.path() / "a.exr");
  ASSERT_TRUE(reader->layout().floating);
  std::vector<float> pixels(image.rgb.size());
  ASSERT_TRUE(reader->read(0, image.height, 3, pixels.data()));
  for (std::size_t k = 0; k < pixels.size(); ++k) {
    const double linear = to_linear(image.rgb[k] / 255.0);
    // Half floats have eleven significant bits, and steps of 2^-24 below 2^-14.
    EXPECT_NEAR(pixels[k], linear, std::max(linear * std::ldexp(1.0, -11), std::ldexp(1.0, -24))) << k;
  }
}

TEST(Image, RefusesFormatsThatItCannotWrite) {
  const TemporaryFolder folder;
  EXPECT_THROW(write_picture(colorful(), folder.path() / "a.gif", {}), FileError);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "a.gif"));
}

TEST(Image, DropsAlpha) {
  const TemporaryFolder folder;
  write_text(folder.path() / "a.png",
             encode_png(2, 1, 4, std::vector<std::uint8_t>{200, 100, 50, 128, 255, 1, 2, 0}, 6));
  EXPECT_EQ(read_image(folder.path() / "a.png"), (Image{2, 1, {200, 100, 50, 255, 1, 2}}));
}

}  // namespace
}  // namespace rebake::test
