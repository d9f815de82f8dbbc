#include <OpenImageIO/imageio.h>

#include "tests/support/picture_files.h"

extern "C" bool rebake_test_write_picture(const std::string& path, const rebake::test::PictureFile& file,
                                          const float* pixels, std::string& error) {
  OIIO::ImageSpec spec(file.width, file.height, file.channels, OIIO::TypeDesc(file.type));
  spec.tile_width = spec.tile_height = file.tile;
  if (file.whole_height > 0) spec.full_height = file.whole_height;
  const auto output = OIIO::ImageOutput::create(path);
  if (output && output->open(path, spec) && output->write_image(OIIO::TypeDesc::FLOAT, pixels) && output->close())
    return true;
  error = output ? output->geterror() : OIIO::geterror();
  return false;
}
