#include "mesh_ops/formats/mobilenerf/feature_png.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/images/picture_codecs.h"
#include "mesh_ops/formats/images/png_writer.h"
#include "mesh_ops/formats/images/rgba_png.h"
#include "mesh_ops/formats/mobilenerf/dialect.h"

namespace rebake {

namespace {

constexpr int compression_level = 4;  // zlib level; 6 takes four times as long for files a tenth smaller

// A whole WebP image.
class WebpRows : public RgbaRows {
 public:
  explicit WebpRows(WebpImage image) : RgbaRows(image.width, image.height), image_(std::move(image)) {}
  void read(int count) override {
    first_ = next_;
    next_ = std::min(next_ + count, height());
  }
  const std::uint8_t* row(int k) const override {
    return &image_.rgba[static_cast<std::size_t>(first_ + k) * static_cast<std::size_t>(width()) * 4];
  }

 private:
  WebpImage image_;
  int first_ = 0, next_ = 0;
};

std::unique_ptr<RgbaRows> open_webp(std::string_view bytes, const std::filesystem::path& name,
                                    std::vector<std::string>& assumptions) {
  WebpImage image;
  std::string problem;
  if (!picture_codecs(name).decode_webp(bytes, image, problem))
    throw FileError(name, "cannot be decoded as WebP: " + problem);
  assumptions.push_back(name.filename().string() +
                        (image.lossless ? " is a WebP file, which exports replace by a PNG"
                                        : " is compressed with loss: its features are not the baked ones"));
  return std::make_unique<WebpRows>(std::move(image));
}

// Decodes any other PNG through OpenImageIO. Reports why a file cannot be a feature texture.
class OtherPng : public RgbaRows {
 public:
  static std::unique_ptr<OtherPng> open(std::string_view bytes, const std::filesystem::path& name, std::size_t red) {
    if (bytes.empty()) throw FileError(name, "is empty (0 bytes); a feature image was expected");
    if (!bytes.starts_with("\x89PNG\r\n\x1a\n")) throw FileError(name, "is neither a PNG nor a WebP file");
    std::string problem;
    auto reader = picture_codecs(name).open_memory("png", bytes, name.string(), problem);
    if (!reader) throw FileError(name, "cannot be decoded: " + problem);
    const PictureLayout& layout = reader->layout();
    if (layout.width < 1 || layout.height < 1 || layout.width > largest_png_side || layout.height > largest_png_side)
      throw FileError(name, fmt::format("declares {}×{} texels; at most {}² can be read", layout.width, layout.height,
                                        largest_png_side));
    if (layout.channels > 4)
      throw FileError(name, fmt::format("has {} channels; feature textures have 4 (RGBA)", layout.channels));
    if (layout.type != "uint8" && layout.type != "uint16")
      throw FileError(name, fmt::format("must have 8 or 16 bits per channel, not {}", layout.type));
    return std::make_unique<OtherPng>(std::move(reader), name, red);
  }
  OtherPng(std::unique_ptr<PictureReader> reader, const std::filesystem::path& name, std::size_t red)
      : RgbaRows(reader->layout().width, reader->layout().height),
        name_(name),
        reader_(std::move(reader)),
        channels_(static_cast<std::size_t>(reader_->layout().channels)),
        wide_(reader_->layout().type == "uint16"),
        red_(channels_ < 3 && red < 4 ? 0 : red) {
    if (channels_ < 3) note("is grey, so that red, green and blue are equal");
    if (channels_ % 2 == 1) note("has no alpha: the fourth feature has the byte 255");
    if (wide_) note("has 16 bits per channel, which are rounded to 8");
    needs_repair_ = wide_;
  }

  void read(int count) override {
    const int end = std::min(first_ + count, height());
    const std::size_t texels = static_cast<std::size_t>(width()) * static_cast<std::size_t>(end - first_);
    rgba_.resize(texels * 4);
    if (wide_)
      read_wide(end, texels);
    else
      read_bytes(end, texels);
    first_ = end;
  }
  const std::uint8_t* row(int k) const override {
    return &rgba_[static_cast<std::size_t>(k) * static_cast<std::size_t>(width()) * 4];
  }
  const std::vector<std::string>& assumptions() const { return assumptions_; }
  bool needs_repair() const { return needs_repair_; }

 private:
  void note(const std::string& text) { assumptions_.push_back(name_.filename().string() + " " + text); }

  template <class T>
  void decode(int end, T* values) {
    if (!reader_->read(first_, end - first_, static_cast<int>(channels_), values))
      throw FileError(name_, "cannot be decoded, it may be truncated: " + reader_->error());
  }

  // Spreads the channels of the texels, which `byte(texel, channel)` returns, over RGBA.
  template <class Byte>
  void spread(std::size_t texels, const Byte& byte) {
    const bool grey = channels_ < 3, alpha = channels_ % 2 == 0;
    for (std::size_t k = 0; k < texels; ++k) {
      for (std::size_t c = 0; c < 3; ++c) rgba_[4 * k + c] = byte(k, grey ? 0 : c);
      rgba_[4 * k + 3] = alpha ? byte(k, channels_ - 1) : std::uint8_t{255};
    }
  }

  void read_bytes(int end, std::size_t texels) {
    if (channels_ == 4) return decode(end, rgba_.data());
    bytes_.resize(texels * channels_);
    decode(end, bytes_.data());
    spread(texels, [&](std::size_t k, std::size_t c) { return bytes_[k * channels_ + c]; });
  }

  void read_wide(int end, std::size_t texels) {
    values_.resize(texels * channels_);
    decode(end, values_.data());
    spread(texels, [&](std::size_t k, std::size_t c) {
      const float value = values_[k * channels_ + c];
      const auto byte = static_cast<std::uint8_t>(std::lround(value * 255));
      return c == red_ && value > 0 ? std::max<std::uint8_t>(byte, 1) : byte;
    });
  }

  const std::filesystem::path& name_;
  std::unique_ptr<PictureReader> reader_;
  std::size_t channels_;
  bool wide_;        // 16 bits per channel
  std::size_t red_;  // the channel that decides about holes; 4: none
  bool needs_repair_ = false;
  std::vector<std::string> assumptions_;
  std::vector<std::uint8_t> rgba_, bytes_;
  std::vector<float> values_;
  int first_ = 0;
};

// Whether a PNG has a chunk by which browsers convert colours (gAMA, cHRM, iCCP). They come before the pixels.
bool has_color_space(std::string_view png) {
  for (std::size_t at = 8; at + 8 <= png.size();) {
    const std::string_view name = png.substr(at + 4, 4);
    if (name == "IDAT") return false;
    if (name == "gAMA" || name == "cHRM" || name == "iCCP") return true;
    std::size_t length = 0;
    for (std::size_t k = 0; k < 4; ++k) length = length << 8 | static_cast<unsigned char>(png[at + k]);
    at += 12 + length;
  }
  return false;
}

// Opens a feature image, and appends assumptions.
std::unique_ptr<RgbaRows> open_image(std::string_view bytes, const std::filesystem::path& name, std::size_t image,
                                     const Dialect& dialect, std::vector<std::string>& assumptions,
                                     std::array<bool, 2>& needs_repair) {
  if (bytes.starts_with("\x89PNG") && has_color_space(bytes)) {
    assumptions.push_back(name.filename().string() +
                          " states a colour space, which browsers would apply; it is ignored");
    needs_repair[image] = true;
  }
  if (std::unique_ptr<RgbaRows> png = open_rgba_png(bytes, name)) return png;
  if (bytes.starts_with("RIFF") && bytes.substr(0, 12).ends_with("WEBP")) {
    needs_repair[image] = true;
    return open_webp(bytes, name, assumptions);
  }
  std::unique_ptr<OtherPng> other = OtherPng::open(bytes, name, image == 1 ? 4 : dialect.bgr ? 2 : 0);
  assumptions.insert(assumptions.end(), other->assumptions().begin(), other->assumptions().end());
  needs_repair[image] = needs_repair[image] || other->needs_repair();
  return other;
}

}  // namespace

FeatureImages read_feature_images(std::string_view feat0, const std::filesystem::path& name0, std::string_view feat1,
                                  const std::filesystem::path& name1, AlphaCode code, const Dialect& dialect,
                                  const std::function<void(int, std::size_t)>& passed) {
  std::vector<std::string> assumptions;
  std::array<bool, 2> needs_repair{};
  const std::unique_ptr<RgbaRows> first = open_image(feat0, name0, 0, dialect, assumptions, needs_repair),
                                  second = open_image(feat1, name1, 1, dialect, assumptions, needs_repair);
  const int width = first->width(), height = first->height();
  if (width != second->width() || height != second->height())
    throw FileError(name1, fmt::format("is {}×{} texels, but {} is {}×{}; both images of a set must have the same size",
                                       second->width(), second->height(), name0.filename().string(), width, height));
  std::size_t holes = 0;
  FeatureTexture texels = FeatureTexture::from_parts(width, height, code, [&](int, int count, Texel* to) {
    // An isolated task group: otherwise a failure while other files are read in parallel would cancel this one, which
    // would return with nothing read.
    tbb::task_group_context whole(tbb::task_group_context::isolated);
    tbb::parallel_invoke([&] { first->read(count); }, [&] { second->read(count); }, whole);
    for (int y = 0; y < count; ++y) {
      const std::uint8_t *a = first->row(y), *b = second->row(y);
      for (int x = 0; x < width; ++x, a += 4, b += 4, ++to) {
        std::copy_n(a, 4, to->feat0.begin());
        std::copy_n(b, 4, to->feat1.begin());
      }
      swap_channels(dialect, width, to - width);
      holes += fill_holes(dialect, width, to - width);
    }
    if (!passed) return;
    passed(0, first->bytes_consumed());
    passed(1, second->bytes_consumed());
  });
  if (holes > 0)
    assumptions.push_back(
        fmt::format("{}: {} texels with red 0 are opaque; their first feature becomes 1/255 instead of 0",
                    name0.filename().string(), holes));
  return {std::move(texels), std::move(assumptions), needs_repair};
}

void write_feature_pngs(const TexelRows& texels, const PngEncoder::Sink& feat0, const PngEncoder::Sink& feat1) {
  const PngEncoder::Sink* sinks[] = {&feat0, &feat1};
  std::optional<PngEncoder> encoders[2];
  for (const std::size_t image : {0U, 1U})
    if (*sinks[image]) encoders[image].emplace(texels.width, texels.height, 4, compression_level, *sinks[image]);
  const auto width = static_cast<std::size_t>(texels.width);
  std::vector<Texel> rows(width * static_cast<std::size_t>(std::min(TexelTile::size, texels.height)));
  for (int first = 0; first < texels.height; first += TexelTile::size) {
    const int count = std::min(TexelTile::size, texels.height - first);
    texels.read(first, count, rows.data());
    tbb::task_group_context whole(tbb::task_group_context::isolated);
    tbb::parallel_for(
        std::size_t{0}, std::size_t{2},
        [&](std::size_t image) {
          if (!encoders[image]) return;
          std::vector<std::uint8_t> row(width * 4);
          for (std::size_t y = 0; y < static_cast<std::size_t>(count); ++y) {
            for (std::size_t x = 0; x < width; ++x)
              std::copy_n((image == 0 ? rows[y * width + x].feat0 : rows[y * width + x].feat1).begin(), 4, &row[4 * x]);
            encoders[image]->write_rows(row);
          }
        },
        whole);
  }
  for (auto& encoder : encoders)
    if (encoder) encoder->finish();
}

std::string write_feature_png(const FeatureTexture& texture, int image) {
  std::string bytes;
  const PngEncoder::Sink sink = [&](std::string_view piece) { bytes.append(piece); };
  // A non-owning pointer: the texture outlives this call.
  const std::shared_ptr<const FeatureTexture> borrowed(std::shared_ptr<const void>(), &texture);
  write_feature_pngs(rows_of(borrowed, texture.alpha_code()), image == 0 ? sink : PngEncoder::Sink(),
                     image == 1 ? sink : PngEncoder::Sink());
  return bytes;
}

}  // namespace rebake
