// Rebake's decoder of 8-bit RGBA PNGs agrees with the specification and with OpenImageIO, and rejects damaged files.
#include "mesh_ops/formats/images/rgba_png.h"

#include <gtest/gtest.h>
#include <isa-l/crc.h>
#include <isa-l/igzip_lib.h>

#include <random>

#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/images/png_filters.h"
#include "mesh_ops/formats/mobilenerf/feature_png.h"

namespace rebake::test {
namespace {

using Pixels = std::vector<std::uint8_t>;

std::uint8_t paeth(int left, int above, int corner) {
  const int guess = left + above - corner;
  const int to_left = std::abs(guess - left), to_above = std::abs(guess - above), to_corner = std::abs(guess - corner);
  return static_cast<std::uint8_t>(to_left <= to_above && to_left <= to_corner ? left
                                   : to_above <= to_corner                     ? above
                                                                               : corner);
}

// Reference implementation of PNG filters (section 9 of the specification): rows with filter bytes → pixels.
Pixels reference_unfiltered(const Pixels& rows, int width, int height) {
  const std::size_t bytes = 4 * static_cast<std::size_t>(width);
  Pixels pixels(bytes * static_cast<std::size_t>(height));
  for (std::size_t y = 0; y < static_cast<std::size_t>(height); ++y)
    for (std::size_t k = 0; k < bytes; ++k) {
      const std::size_t at = y * bytes + k;
      const int left = k < 4 ? 0 : pixels[at - 4], above = y == 0 ? 0 : pixels[at - bytes],
                corner = k < 4 || y == 0 ? 0 : pixels[at - bytes - 4];
      const int predictions[] = {0, left, above, (left + above) / 2, paeth(left, above, corner)};
      pixels[at] = static_cast<std::uint8_t>(rows[y * (bytes + 1) + 1 + k] + predictions[rows[y * (bytes + 1)]]);
    }
  return pixels;
}

// Random bytes, with a random filter type for each row.
Pixels random_rows(int width, int height, unsigned seed) {
  std::mt19937 random(seed);
  const std::size_t stride = 1 + 4 * static_cast<std::size_t>(width);
  Pixels rows(stride * static_cast<std::size_t>(height));
  for (std::size_t k = 0; k < rows.size(); ++k) rows[k] = static_cast<std::uint8_t>(random() % (k % stride ? 256 : 5));
  return rows;
}

std::string big_endian(std::uint32_t value) {
  return {static_cast<char>(value >> 24), static_cast<char>(value >> 16), static_cast<char>(value >> 8),
          static_cast<char>(value)};
}

std::string chunk(const std::string& kind, const std::string& data) {
  const std::string counted = kind + data;
  return big_endian(static_cast<std::uint32_t>(data.size())) + counted +
         big_endian(crc32_gzip_refl(0, reinterpret_cast<const unsigned char*>(counted.data()), counted.size()));
}

std::string deflated(const Pixels& rows) {
  std::string result(rows.size() + 1000, '\0');
  isal_zstream stream;
  isal_deflate_stateless_init(&stream);
  stream.gzip_flag = IGZIP_ZLIB;
  stream.end_of_stream = 1;
  stream.next_in = const_cast<std::uint8_t*>(rows.data());
  stream.avail_in = static_cast<std::uint32_t>(rows.size());
  stream.next_out = reinterpret_cast<std::uint8_t*>(result.data());
  stream.avail_out = static_cast<std::uint32_t>(result.size());
  EXPECT_EQ(isal_deflate_stateless(&stream), COMP_OK);
  result.resize(stream.total_out);
  return result;
}

constexpr std::string_view plain_rgba("\x08\x06\0\0\0", 5), interlaced_rgba("\x08\x06\0\0\1", 5);

// A PNG file with the compressed `data` in IDAT chunks of `size` bytes.
std::string png_of(int width, int height, const std::string& data, std::size_t size,
                   std::string_view kind = plain_rgba) {
  std::string file =
      "\x89PNG\r\n\x1a\n" + chunk("IHDR", big_endian(static_cast<std::uint32_t>(width)) +
                                              big_endian(static_cast<std::uint32_t>(height)) + std::string(kind));
  file += chunk("tEXt", "to be passed over");
  for (std::size_t at = 0; at < data.size(); at += size) file += chunk("IDAT", data.substr(at, size));
  return file + chunk("IEND", "");
}

// Pixels of a file, decoded `count` rows at a time; empty if the decoder does not support its kind.
Pixels pixels_of(std::string_view file, int count) {
  const std::filesystem::path name = "a.png";
  const std::unique_ptr<RgbaRows> png = open_rgba_png(file, name);
  if (!png) return {};
  Pixels pixels;
  for (int y = 0; y < png->height(); y += count) {
    png->read(count);
    for (int k = 0; k < std::min(count, png->height() - y); ++k)
      pixels.insert(pixels.end(), png->row(k), png->row(k) + 4 * png->width());
  }
  return pixels;
}

std::string refusal_of(std::string_view file) {
  try {
    pixels_of(file, 4);
    return "";
  } catch (const FileError& error) {
    return error.what();
  }
}

TEST(RgbaPng, UndoesFiltersAsSpecified) {
  for (int width = 1; width <= 9; ++width)
    for (int height = 1; height <= 9; ++height)
      for (unsigned seed = 0; seed < 10; ++seed) {
        const Pixels rows = random_rows(width, height, seed);
        const std::size_t stride = 1 + 4 * static_cast<std::size_t>(width);
        Pixels done = rows;
        done.resize(done.size() + (png_filter_rows - 1) * stride);
        const Pixels above(stride - 1);
        undo_png_filters(done.data(), height, width, above.data());
        Pixels pixels;
        for (int y = 0; y < height; ++y) {
          const auto row = done.begin() + y * static_cast<std::ptrdiff_t>(stride);
          pixels.insert(pixels.end(), row + 1, row + static_cast<std::ptrdiff_t>(stride));
        }
        ASSERT_EQ(pixels, reference_unfiltered(rows, width, height)) << width << "×" << height;
      }
}

TEST(RgbaPng, ReadsRowsInPartsFromChunksOfAnySize) {
  const int width = 53, height = 31;
  const Pixels rows = random_rows(width, height, 7), expected = reference_unfiltered(rows, width, height);
  const std::string data = deflated(rows);
  for (const std::size_t size : {std::size_t{1}, std::size_t{2}, std::size_t{100}, data.size()})
    for (const int count : {1, 4, 7, 31, 100}) EXPECT_EQ(pixels_of(png_of(width, height, data, size), count), expected);
}

// Rows repeat earlier rows at almost the maximum distance of deflate, from parts whose filters are already undone.
TEST(RgbaPng, ResolvesDistancesAcrossParts) {
  const int width = 481, height = 200;  // 17 rows are 32,725 bytes
  const std::size_t stride = 1 + 4 * width;
  Pixels rows = random_rows(width, height, 5);
  for (std::size_t k = 17 * stride; k < rows.size(); ++k)
    if (k / stride % 5 != 0) rows[k] = rows[k - 17 * stride];
  const std::string data = deflated(rows);
  EXPECT_LT(data.size(), rows.size() * 2 / 3);
  const Pixels expected = reference_unfiltered(rows, width, height);
  for (const int count : {1, 16, 17, 64, 200}) EXPECT_EQ(pixels_of(png_of(width, height, data, 4000), count), expected);
}

TEST(RgbaPng, LeavesOtherKindsToOpenImageIO) {
  // One pixel, so that interlacing changes only the header.
  const Pixels pixel = {0, 1, 2, 3, 4};
  const std::string plain = png_of(1, 1, deflated(pixel), 100),
                    interlaced = png_of(1, 1, deflated(pixel), 100, interlaced_rgba);
  const std::filesystem::path name = "a.png";
  EXPECT_TRUE(open_rgba_png(plain, name));
  EXPECT_FALSE(open_rgba_png(interlaced, name));
  const FeatureTexture read = read_feature_images(plain, name, interlaced, name, AlphaCode::plain).texels;
  const Texel texel = TexelReader(read).at(0, 0);
  EXPECT_EQ(texel.feat0, (std::array<std::uint8_t, 4>{1, 2, 3, 4}));
  EXPECT_EQ(texel.feat1, texel.feat0);
}

TEST(RgbaPng, RejectsDamagedFilesWithReason) {
  const int width = 5, height = 7;
  const std::string data = deflated(random_rows(width, height, 1)), file = png_of(width, height, data, 50);
  EXPECT_EQ(refusal_of(file), "");
  const std::size_t end = file.size() - 12;  // before IEND, which is not needed
  for (std::size_t size = 50; size < end; ++size)
    EXPECT_NE(refusal_of(file.substr(0, size)).find("is truncated"), std::string::npos) << size;
  const std::size_t title = file.find("to be passed over");
  for (std::size_t at = 8; at < end; ++at) {
    // Damage in the skipped tEXt chunk has no effect.
    if (at + 4 >= title && at < title + 17 + 4) continue;
    std::string damaged = file;
    damaged[at] = static_cast<char>(damaged[at] ^ 4);
    EXPECT_NE(refusal_of(damaged), "") << at;
  }
  EXPECT_NE(refusal_of(png_of(width, height + 1, data, 50)).find("is truncated"), std::string::npos);
  const std::string unchecked = data.substr(0, data.size() - 4);
  EXPECT_NE(refusal_of(png_of(width, height, unchecked, 50)).find("is truncated"), std::string::npos);
  for (const std::size_t size : {data.size() - 2, std::size_t{50}})
    EXPECT_NE(refusal_of(png_of(width, height, unchecked + "abcd", size)).find("cannot be inflated"),
              std::string::npos);
  Pixels rows = random_rows(width, height, 1);
  rows[4 * (1 + 4 * width)] = 5;
  EXPECT_NE(refusal_of(png_of(width, height, deflated(rows), 50)).find("row 4 has an invalid filter type"),
            std::string::npos);
}

// Corrupt deflate data with valid chunk checksums: no access out of bounds.
TEST(RgbaPng, SurvivesCorruptDeflateData) {
  const int width = 20, height = 9;
  const Pixels rows = random_rows(width, height, 2), expected = reference_unfiltered(rows, width, height);
  const std::string data = deflated(rows);
  for (std::size_t at = 0; at < data.size(); ++at)
    for (const int change : {1, 16, 255}) {
      std::string damaged = data;
      damaged[at] = static_cast<char>(damaged[at] ^ change);
      const std::string file = png_of(width, height, damaged, 64);
      // Some bits do not affect pixels, such as the compression level in the zlib header.
      if (refusal_of(file).empty()) {
        EXPECT_EQ(pixels_of(file, 4), expected) << at << ", " << change;
      }
    }
}

}  // namespace
}  // namespace rebake::test
