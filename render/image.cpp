#include "render/image.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <string_view>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"

namespace rebake {

Image read_image(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) throw FileError(path, "does not exist");
  if (!std::filesystem::is_regular_file(path)) throw FileError(path, "is no regular file");
  const auto input = OIIO::ImageInput::open(path.string());
  if (!input) throw FileError(path, "cannot be read as a picture: " + OIIO::geterror());
  const OIIO::ImageSpec& spec = input->spec();
  if (spec.width > 32768 || spec.height > 32768) throw FileError(path, "is larger than 32768 pixels a side");
  const int channels = spec.nchannels;
  std::vector<std::uint8_t> raw(static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height) *
                                static_cast<std::size_t>(channels));
  Image image{spec.width, spec.height, {}};
  if (!input->read_image(0, 0, 0, channels, OIIO::TypeDesc::UINT8, raw.data()))
    throw FileError(path, "cannot be decoded, it may be truncated: " + input->geterror());
  image.rgb.reserve(raw.size());
  for (std::size_t p = 0; p < raw.size(); p += static_cast<std::size_t>(channels))
    for (std::size_t c = 0; c < 3; ++c) image.rgb.push_back(raw[p + (channels >= 3 ? c : 0)]);
  return image;
}

void write_png(const Image& image, const std::filesystem::path& path, const SourceGuard& guard) {
  guard.check_file(path);  // before the work
  std::vector<unsigned char> encoded;
  OIIO::Filesystem::IOVecOutput sink(encoded);
  const auto output = OIIO::ImageOutput::create("png");
  OIIO::ImageSpec spec(image.width, image.height, 3, OIIO::TypeDesc::UINT8);
  void* proxy = static_cast<OIIO::Filesystem::IOProxy*>(&sink);
  spec.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
  if (!output || !output->open("picture.png", spec) || !output->write_image(OIIO::TypeDesc::UINT8, image.rgb.data()) ||
      !output->close())
    throw FileError(path, "cannot be encoded as PNG: " + (output ? output->geterror() : OIIO::geterror()));
  write_file_atomically(path, std::string_view(reinterpret_cast<const char*>(encoded.data()), encoded.size()), guard);
}

}  // namespace rebake
