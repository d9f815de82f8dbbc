#include "mesh_ops/formats/images/picture_codecs.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <utility>

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

  std::unique_ptr<PictureReader> open_png(std::string_view bytes, const std::string& name,
                                          std::string& error) const override {
    auto source = std::make_unique<OIIO::Filesystem::IOMemReader>(const_cast<char*>(bytes.data()), bytes.size());
    OIIO::ImageSpec config, spec;
    config.attribute("oiio:UnassociatedAlpha", 1);
    void* proxy = source.get();
    config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
    auto input = OIIO::ImageInput::create("png");
    if (!input || !input->open(name, spec, config)) {
      error = input ? input->geterror() : "OpenImageIO has no PNG reader; install libopenimageio with PNG support";
      return nullptr;
    }
    return std::make_unique<Reader>(std::move(input), std::move(source));
  }
};

}  // namespace

extern "C" const rebake::PictureCodecs* rebake_picture_codecs() {
  static const Codecs codecs;
  return &codecs;
}
