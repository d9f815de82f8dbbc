#include <OpenImageIO/imageio.h>
#include <webp/encode.h>

#include <cmath>
#include <cstdint>
#include <fstream>
#include <vector>

#include "tests/support/picture_files.h"

namespace {

// Without loss, and not premultiplied: OpenImageIO's writer does neither.
bool write_webp(const std::string& path, const rebake::test::PictureFile& file, const float* pixels) {
  std::vector<std::uint8_t> rgba;
  for (std::size_t k = 0; k < static_cast<std::size_t>(file.width * file.height * 4); ++k)
    rgba.push_back(static_cast<std::uint8_t>(std::lround(pixels[k] * 255)));
  std::uint8_t* written = nullptr;
  const std::size_t size = WebPEncodeLosslessRGBA(rgba.data(), file.width, file.height, 4 * file.width, &written);
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(written), static_cast<std::streamsize>(size));
  WebPFree(written);
  return size > 0;
}

}  // namespace

extern "C" bool rebake_test_write_picture(const std::string& path, const rebake::test::PictureFile& file,
                                          const float* pixels, std::string& error) {
  if (path.ends_with(".webp")) return write_webp(path, file, pixels);
  OIIO::ImageSpec spec(file.width, file.height, file.channels, OIIO::TypeDesc(file.type));
  spec.tile_width = spec.tile_height = file.tile;
  spec.attribute("oiio:UnassociatedAlpha", 1);
  if (file.whole_height > 0) spec.full_height = file.whole_height;
  const auto output = OIIO::ImageOutput::create(path);
  if (output && output->open(path, spec) && output->write_image(OIIO::TypeDesc::FLOAT, pixels) && output->close())
    return true;
  error = output ? output->geterror() : OIIO::geterror();
  return false;
}
