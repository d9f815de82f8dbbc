#include "mesh_ops/formats/images/picture_codecs.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <webp/decode.h>
#include <webp/encode.h>

#include <utility>
#include <vector>

namespace {

using rebake::PictureLayout;
using rebake::PictureReader;

PictureLayout layout_of(const OIIO::ImageSpec& spec) {
  return {spec.width,
          spec.height,
          spec.nchannels,
          spec.full_width,
          spec.full_height,
          spec.x != spec.full_x || spec.y != spec.full_y || spec.width != spec.full_width ||
              spec.height != spec.full_height,
          spec.format.is_floating_point(),
          spec.format.c_str(),
          std::string(spec.get_string_attribute("oiio:ColorSpace")),
          spec.tile_height > 0 ? spec.tile_height : 1};
}

class Reader : public PictureReader {
 public:
  Reader(std::unique_ptr<OIIO::ImageInput> input, std::unique_ptr<OIIO::Filesystem::IOMemReader> source = nullptr)
      : PictureReader(layout_of(input->spec())), source_(std::move(source)), input_(std::move(input)) {}

  bool read(int first, int count, int channels, std::uint8_t* to) override {
    return read_as(OIIO::TypeDesc::UINT8, first, count, channels, to);
  }
  bool read(int first, int count, int channels, float* to) override {
    return read_as(OIIO::TypeDesc::FLOAT, first, count, channels, to);
  }
  std::string error() const override { return input_->geterror(); }

 private:
  bool read_as(const OIIO::TypeDesc& type, int first, int count, int channels, void* to) {
    const OIIO::ImageSpec& spec = input_->spec();
    const int top = spec.y + first;
    return spec.tile_height > 0
               ? input_->read_tiles(0, 0, spec.x, spec.x + spec.width, top, top + count, 0, 1, 0, channels, type, to)
               : input_->read_scanlines(0, 0, top, top + count, 0, 0, channels, type, to);
  }

  std::unique_ptr<OIIO::Filesystem::IOMemReader> source_;
  std::unique_ptr<OIIO::ImageInput> input_;
};

class Codecs : public rebake::PictureCodecs {
 public:
  std::unique_ptr<PictureReader> open(const std::filesystem::path& path, std::string& error) const override {
    OIIO::ImageSpec config;
    config.attribute("oiio:UnassociatedAlpha", 1);
    auto input = OIIO::ImageInput::open(path.string(), &config);
    if (!input) {
      error = OIIO::geterror();
      return nullptr;
    }
    return std::make_unique<Reader>(std::move(input));
  }

  std::unique_ptr<PictureReader> open_memory(const std::string& format, std::string_view bytes, const std::string& name,
                                             std::string& error) const override {
    auto source = std::make_unique<OIIO::Filesystem::IOMemReader>(const_cast<char*>(bytes.data()), bytes.size());
    OIIO::ImageSpec config, spec;
    config.attribute("oiio:UnassociatedAlpha", 1);
    void* proxy = source.get();
    config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
    auto input = OIIO::ImageInput::create(format);
    if (!input || !input->open(name, spec, config)) {
      error = input ? input->geterror()
                    : "OpenImageIO cannot read " + format + "; install libopenimageio with support for it";
      return nullptr;
    }
    return std::make_unique<Reader>(std::move(input), std::move(source));
  }

  bool decode_webp(std::string_view bytes, rebake::WebpImage& image, std::string& error) const override {
    const auto* const data = reinterpret_cast<const std::uint8_t*>(bytes.data());
    WebPBitstreamFeatures features;
    if (WebPGetFeatures(data, bytes.size(), &features) != VP8_STATUS_OK || features.has_animation != 0) {
      error = "it is not a WebP image, or an animation";
      return false;
    }
    constexpr int lossless = 2;
    image = {features.width, features.height, features.format == lossless, {}};
    image.rgba.resize(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * 4);
    if (WebPDecodeRGBAInto(data, bytes.size(), image.rgba.data(), image.rgba.size(), image.width * 4) != nullptr)
      return true;
    error = "it may be truncated";
    return false;
  }

  bool encode(const std::string& format, int width, int height, int channels, const std::uint8_t* pixels,
              std::string& bytes, std::string& error) const override {
    // OpenImageIO's own WebP files are not without loss.
    if (format == "webp") return encode_webp(width, height, channels, pixels, bytes, error);
    return encode_as(format, {width, height, channels, OIIO::TypeDesc::UINT8}, OIIO::TypeDesc::UINT8, pixels, bytes,
                     error);
  }
  bool encode_exr(int width, int height, const std::vector<rebake::FloatChannel>& channels,
                  const std::vector<std::pair<std::string, std::string>>& attributes, const float* pixels,
                  std::string& bytes, std::string& error) const override {
    OIIO::ImageSpec spec(width, height, static_cast<int>(channels.size()), OIIO::TypeDesc::FLOAT);
    spec.channelnames.clear();
    spec.channelformats.clear();
    bool all_half = true;
    for (const rebake::FloatChannel& channel : channels) {
      spec.channelnames.push_back(channel.name);
      spec.channelformats.emplace_back(channel.half ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::FLOAT);
      all_half = all_half && channel.half;
    }
    if (all_half) {
      spec.channelformats.clear();
      spec.format = OIIO::TypeDesc::HALF;
    }
    spec.attribute("oiio:ColorSpace", "Linear");
    spec.attribute("DateTime", "");  // otherwise OpenImageIO writes the present time, and equal pictures differ
    for (const auto& [name, text] : attributes) spec.attribute(name, text);
    return encode_as("openexr", spec, OIIO::TypeDesc::FLOAT, pixels, bytes, error);
  }

 private:
  static bool encode_webp(int width, int height, int channels, const std::uint8_t* pixels, std::string& bytes,
                          std::string& error) {
    std::uint8_t* written = nullptr;
    const std::size_t size = channels == 4 ? WebPEncodeLosslessRGBA(pixels, width, height, 4 * width, &written)
                                           : WebPEncodeLosslessRGB(pixels, width, height, 3 * width, &written);
    if (size == 0) {
      error = "the picture is too large for WebP, which holds at most 16383² pixels";
      return false;
    }
    bytes.assign(reinterpret_cast<const char*>(written), size);
    WebPFree(written);
    return true;
  }

  static bool encode_as(const std::string& format, OIIO::ImageSpec spec, const OIIO::TypeDesc& type, const void* pixels,
                        std::string& bytes, std::string& error) {
    std::vector<unsigned char> written;
    OIIO::Filesystem::IOVecOutput target(written);
    OIIO::Filesystem::IOProxy* proxy = &target;
    spec.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
    if (format != "openexr") spec.attribute("oiio:ColorSpace", "sRGB");
    spec.attribute("compression", format == "jpeg" ? "jpeg:95" : "zip");
    spec.attribute("jpeg:subsampling", "4:4:4");
    const auto output = OIIO::ImageOutput::create(format);
    if (!output) {
      error = "OpenImageIO cannot write this format; install libopenimageio with support for it";
      return false;
    }
    if (!output->open("picture." + format, spec) || !output->write_image(type, pixels) || !output->close()) {
      error = output->geterror();
      return false;
    }
    bytes.assign(written.begin(), written.end());
    return true;
  }
};

}  // namespace

extern "C" const rebake::PictureCodecs* rebake_picture_codecs() {
  static const Codecs codecs;
  return &codecs;
}
