#include "mesh_ops/formats/feature_png.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "mesh_ops/base/error.h"

namespace rebake {

namespace {

constexpr int largest_side = 16384;
constexpr int compression_level = 4;  // 1.4 s for 4096² RGBA; 6 takes 6 s for a tenth less (measured)

struct Pixels {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;
};

Pixels decode_png(std::string_view bytes, const std::filesystem::path& name) {
  if (bytes.empty()) throw FileError(name, "is empty (0 bytes); a feature PNG was expected");
  if (!bytes.starts_with("\x89PNG\r\n\x1a\n")) throw FileError(name, "is not a PNG file");
  OIIO::Filesystem::IOMemReader source(const_cast<char*>(bytes.data()), bytes.size());
  OIIO::ImageSpec config;
  config.attribute("oiio:UnassociatedAlpha", 1);
  const auto input = OIIO::ImageInput::create("png");
  if (!input) throw Error("OpenImageIO has no PNG reader; install libopenimageio with PNG support");
  void* proxy = &source;
  config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
  OIIO::ImageSpec spec;
  if (!input->open(name.string(), spec, config)) throw FileError(name, "cannot be decoded: " + input->geterror());
  if (spec.width < 1 || spec.height < 1 || spec.width > largest_side || spec.height > largest_side)
    throw FileError(
        name, fmt::format("declares {}×{} texels; at most {}² can be read", spec.width, spec.height, largest_side));
  if (spec.nchannels != 4)
    throw FileError(name, fmt::format("has {} channels; feature textures have 4 (RGBA)", spec.nchannels));
  if (spec.format != OIIO::TypeDesc::UINT8)
    throw FileError(name, fmt::format("is not 8 bits a channel (it holds {})", spec.format.c_str()));
  Pixels pixels{spec.width, spec.height, {}};
  pixels.rgba.resize(static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height) * 4);
  if (!input->read_image(0, 0, 0, 4, OIIO::TypeDesc::UINT8, pixels.rgba.data()))
    throw FileError(name, "cannot be decoded, it may be truncated: " + input->geterror());
  input->close();
  return pixels;
}

}  // namespace

FeatureTexture read_feature_pngs(std::string_view feat0, const std::filesystem::path& name0, std::string_view feat1,
                                 const std::filesystem::path& name1, AlphaCode code) {
  Pixels first, second;
  tbb::parallel_invoke([&] { first = decode_png(feat0, name0); }, [&] { second = decode_png(feat1, name1); });
  if (first.width != second.width || first.height != second.height)
    throw FileError(
        name1, fmt::format("is {}×{} texels, but {} is {}×{}; both images of a set must be of one size", second.width,
                           second.height, name0.filename().string(), first.width, first.height));
  const auto width = static_cast<std::size_t>(first.width);
  return FeatureTexture::from_rows(first.width, first.height, code, [&](int y, Texel* row) {
    const std::uint8_t* a = first.rgba.data() + static_cast<std::size_t>(y) * width * 4;
    const std::uint8_t* b = second.rgba.data() + static_cast<std::size_t>(y) * width * 4;
    for (std::size_t x = 0; x < width; ++x) {
      std::copy_n(a + x * 4, 4, row[x].feat0.begin());
      std::copy_n(b + x * 4, 4, row[x].feat1.begin());
    }
  });
}

std::string write_feature_png(const FeatureTexture& texture, int image) {
  std::vector<unsigned char> encoded;
  OIIO::Filesystem::IOVecOutput sink(encoded);
  const auto output = OIIO::ImageOutput::create("png");
  if (!output) throw Error("OpenImageIO has no PNG writer; install libopenimageio with PNG support");
  OIIO::ImageSpec spec(texture.width(), texture.height(), 4, OIIO::TypeDesc::UINT8);
  spec.alpha_channel = 3;
  spec.attribute("oiio:UnassociatedAlpha", 1);
  spec.attribute("png:compressionLevel", compression_level);
  void* proxy = static_cast<OIIO::Filesystem::IOProxy*>(&sink);
  spec.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
  if (!output->open("feature.png", spec)) throw Error("a feature PNG cannot be encoded: " + output->geterror());
  std::vector<std::uint8_t> rgba(static_cast<std::size_t>(texture.width()) *
                                 static_cast<std::size_t>(texture.height()) * 4);
  std::size_t at = 0;
  for (int y = 0; y < texture.height(); ++y)
    for (int x = 0; x < texture.width(); ++x, at += 4)
      std::copy_n((image == 0 ? texture.at(x, y).feat0 : texture.at(x, y).feat1).begin(), 4,
                  rgba.begin() + static_cast<std::ptrdiff_t>(at));
  if (!output->write_image(OIIO::TypeDesc::UINT8, rgba.data()) || !output->close())
    throw Error("a feature PNG cannot be encoded: " + output->geterror());
  return {encoded.begin(), encoded.end()};
}

}  // namespace rebake
