#include "mesh_ops/formats/mobilenerf/feature_png.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <vector>

#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/images/picture_codecs.h"
#include "mesh_ops/formats/images/png_writer.h"
#include "mesh_ops/formats/images/rgba_png.h"

namespace rebake {

namespace {

constexpr int compression_level = 4;  // zlib level; 6 takes four times as long for files a tenth smaller

// Decodes any other PNG through OpenImageIO, such as interlaced ones. Reports why a file cannot be a feature texture.
class OtherPng : public RgbaRows {
 public:
  static std::unique_ptr<RgbaRows> open(std::string_view bytes, const std::filesystem::path& name) {
    if (bytes.empty()) throw FileError(name, "is empty (0 bytes); a feature PNG was expected");
    if (!bytes.starts_with("\x89PNG\r\n\x1a\n")) throw FileError(name, "is not a PNG file");
    std::string problem;
    auto reader = picture_codecs(name).open_png(bytes, name.string(), problem);
    if (!reader) throw FileError(name, "cannot be decoded: " + problem);
    const PictureLayout& layout = reader->layout();
    if (layout.width < 1 || layout.height < 1 || layout.width > largest_png_side || layout.height > largest_png_side)
      throw FileError(name, fmt::format("declares {}×{} texels; at most {}² can be read", layout.width, layout.height,
                                        largest_png_side));
    if (layout.channels != 4)
      throw FileError(name, fmt::format("has {} channels; feature textures have 4 (RGBA)", layout.channels));
    if (layout.type != "uint8") throw FileError(name, fmt::format("must have 8 bits per channel, not {}", layout.type));
    return std::make_unique<OtherPng>(std::move(reader), name);
  }
  OtherPng(std::unique_ptr<PictureReader> reader, const std::filesystem::path& name)
      : RgbaRows(reader->layout().width, reader->layout().height), name_(name), reader_(std::move(reader)) {}

  void read(int count) override {
    const int end = std::min(first_ + count, height());
    rgba_.resize(static_cast<std::size_t>(width()) * static_cast<std::size_t>(end - first_) * 4);
    if (!reader_->read(first_, end - first_, 4, rgba_.data()))
      throw FileError(name_, "cannot be decoded, it may be truncated: " + reader_->error());
    first_ = end;
  }
  const std::uint8_t* row(int k) const override {
    return &rgba_[static_cast<std::size_t>(k) * static_cast<std::size_t>(width()) * 4];
  }

 private:
  const std::filesystem::path& name_;
  std::unique_ptr<PictureReader> reader_;
  std::vector<std::uint8_t> rgba_;
  int first_ = 0;
};

std::unique_ptr<RgbaRows> open_png(std::string_view bytes, const std::filesystem::path& name) {
  std::unique_ptr<RgbaRows> png = open_rgba_png(bytes, name);
  return png ? std::move(png) : OtherPng::open(bytes, name);
}

}  // namespace

FeatureTexture read_feature_pngs(std::string_view feat0, const std::filesystem::path& name0, std::string_view feat1,
                                 const std::filesystem::path& name1, AlphaCode code,
                                 const std::function<void(int, std::size_t)>& passed) {
  const std::unique_ptr<RgbaRows> first = open_png(feat0, name0), second = open_png(feat1, name1);
  const int width = first->width(), height = first->height();
  if (width != second->width() || height != second->height())
    throw FileError(name1, fmt::format("is {}×{} texels, but {} is {}×{}; both images of a set must have the same size",
                                       second->width(), second->height(), name0.filename().string(), width, height));
  return FeatureTexture::from_parts(width, height, code, [&](int, int count, Texel* texels) {
    // An isolated task group: otherwise a failure while other files are read in parallel would cancel this one, which
    // would return with nothing read.
    tbb::task_group_context whole(tbb::task_group_context::isolated);
    tbb::parallel_invoke([&] { first->read(count); }, [&] { second->read(count); }, whole);
    for (int y = 0; y < count; ++y) {
      const std::uint8_t *a = first->row(y), *b = second->row(y);
      for (int x = 0; x < width; ++x, a += 4, b += 4, ++texels) {
        std::copy_n(a, 4, texels->feat0.begin());
        std::copy_n(b, 4, texels->feat1.begin());
      }
    }
    if (!passed) return;
    passed(0, first->bytes_consumed());
    passed(1, second->bytes_consumed());
  });
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
