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

// A PNG that is decoded from its top on.
class PngRows {
 public:
  PngRows(std::string_view bytes, const std::filesystem::path& name)
      : name_(name), source_(const_cast<char*>(bytes.data()), bytes.size()) {
    if (bytes.empty()) throw FileError(name, "is empty (0 bytes); a feature PNG was expected");
    if (!bytes.starts_with("\x89PNG\r\n\x1a\n")) throw FileError(name, "is not a PNG file");
    OIIO::ImageSpec config;
    config.attribute("oiio:UnassociatedAlpha", 1);
    input_ = OIIO::ImageInput::create("png");
    if (!input_) throw Error("OpenImageIO has no PNG reader; install libopenimageio with PNG support");
    void* proxy = &source_;
    config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
    if (!input_->open(name.string(), spec_, config)) throw FileError(name, "cannot be decoded: " + input_->geterror());
    if (spec_.width < 1 || spec_.height < 1 || spec_.width > largest_side || spec_.height > largest_side)
      throw FileError(
          name, fmt::format("declares {}×{} texels; at most {}² can be read", spec_.width, spec_.height, largest_side));
    if (spec_.nchannels != 4)
      throw FileError(name, fmt::format("has {} channels; feature textures have 4 (RGBA)", spec_.nchannels));
    if (spec_.format != OIIO::TypeDesc::UINT8)
      throw FileError(name, fmt::format("is not 8 bits a channel (it holds {})", spec_.format.c_str()));
  }

  int width() const { return spec_.width; }
  int height() const { return spec_.height; }

  /// The next rows; those before have been read.
  const std::vector<std::uint8_t>& read(int first, int count) {
    rgba_.resize(static_cast<std::size_t>(spec_.width) * static_cast<std::size_t>(count) * 4);
    if (!input_->read_scanlines(0, 0, first, first + count, 0, 0, 4, OIIO::TypeDesc::UINT8, rgba_.data()))
      throw FileError(name_, "cannot be decoded, it may be truncated: " + input_->geterror());
    return rgba_;
  }

 private:
  const std::filesystem::path& name_;
  OIIO::Filesystem::IOMemReader source_;
  std::unique_ptr<OIIO::ImageInput> input_;
  OIIO::ImageSpec spec_;
  std::vector<std::uint8_t> rgba_;
};

}  // namespace

FeatureTexture read_feature_pngs(std::string_view feat0, const std::filesystem::path& name0, std::string_view feat1,
                                 const std::filesystem::path& name1, AlphaCode code) {
  PngRows first(feat0, name0), second(feat1, name1);
  if (first.width() != second.width() || first.height() != second.height())
    throw FileError(
        name1, fmt::format("is {}×{} texels, but {} is {}×{}; both images of a set must be of one size", second.width(),
                           second.height(), name0.filename().string(), first.width(), first.height()));
  return FeatureTexture::from_parts(first.width(), first.height(), code, [&](int y, int count, Texel* rows) {
    const std::uint8_t *a = nullptr, *b = nullptr;
    // Of its own: where other files are read beside these and one of them fails, this would return with nothing read.
    tbb::task_group_context whole(tbb::task_group_context::isolated);
    tbb::parallel_invoke([&] { a = first.read(y, count).data(); }, [&] { b = second.read(y, count).data(); }, whole);
    const std::size_t texels = static_cast<std::size_t>(first.width()) * static_cast<std::size_t>(count);
    for (std::size_t k = 0; k < texels; ++k) {
      std::copy_n(a + k * 4, 4, rows[k].feat0.begin());
      std::copy_n(b + k * 4, 4, rows[k].feat1.begin());
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
