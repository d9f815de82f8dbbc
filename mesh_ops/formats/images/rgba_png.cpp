#include "mesh_ops/formats/images/rgba_png.h"

#include <fmt/format.h>
#include <isa-l/crc.h>
#include <isa-l/igzip_lib.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/images/png_filters.h"

namespace rebake {

namespace {

std::uint32_t big_endian(std::string_view bytes) {
  std::uint32_t value = 0;
  for (int k = 0; k < 4; ++k) value = value << 8 | static_cast<std::uint8_t>(bytes[static_cast<std::size_t>(k)]);
  return value;
}

bool critical(std::string_view kind) { return (kind[0] & 0x20) == 0; }

struct Chunk {
  std::string_view kind, data;
};

// Iterates over the chunks of a PNG.
class Chunks {
 public:
  Chunks(std::string_view bytes, const std::filesystem::path& name) : bytes_(bytes), name_(name) {}

  // The next chunk; empty at the end of the file. Throws FileError for truncated chunks and for wrong checksums of
  // critical ones.
  std::optional<Chunk> next() {
    if (at_ == bytes_.size()) return std::nullopt;
    const std::string_view rest = bytes_.substr(at_);
    if (rest.size() < 12 || big_endian(rest) > rest.size() - 12)
      throw FileError(name_,
                      fmt::format("is truncated: its last chunk, at byte {}, is incomplete; copy it again", at_));
    const std::size_t size = big_endian(rest);
    const std::string_view counted = rest.substr(4, 4 + size);
    const auto* first = reinterpret_cast<const unsigned char*>(counted.data());
    // Checksums of ancillary chunks are not checked, since no pixel depends on them.
    const bool needed = critical(counted);
    if (needed && crc32_gzip_refl(0, first, counted.size()) != big_endian(rest.substr(8 + size)))
      throw FileError(name_,
                      fmt::format("is damaged: the checksum of its chunk at byte {} is wrong; copy it again", at_));
    at_ += 12 + size;
    return Chunk{counted.substr(0, 4), counted.substr(4)};
  }

 private:
  std::string_view bytes_;
  const std::filesystem::path& name_;
  std::size_t at_ = 8;
};

class RgbaPng : public RgbaRows {
 public:
  RgbaPng(int width, int height, std::string_view bytes, Chunks chunks, std::string_view data,
          const std::filesystem::path& name)
      : RgbaRows(width, height),
        name_(name),
        bytes_(bytes),
        chunks_(chunks),
        stride_(1 + 4 * static_cast<std::size_t>(width)),
        above_(stride_ - 1) {
    isal_inflate_init(&inflate_);
    inflate_.crc_flag = ISAL_ZLIB;
    feed(data);
  }

  void read(int count) override {
    if (count_ > 0) std::copy_n(row(count_ - 1), above_.size(), above_.begin());
    count_ = std::min(count, height() - first_);
    rows_.resize(static_cast<std::size_t>(count_ + png_filter_rows - 1) * stride_);
    inflate(static_cast<std::size_t>(count_) * stride_);
    if (first_ + count_ == height()) finish();
    const int unknown = first_unknown_png_filter(rows_.data(), count_, stride_);
    if (unknown < count_)
      throw FileError(name_,
                      fmt::format("is damaged: row {} has an invalid filter type; copy it again", first_ + unknown));
    undo_png_filters(rows_.data(), count_, width(), above_.data());
    first_ += count_;
  }
  const std::uint8_t* row(int k) const override { return &rows_[static_cast<std::size_t>(k) * stride_ + 1]; }
  std::size_t bytes_consumed() const override {
    return static_cast<std::size_t>(inflate_.next_in - reinterpret_cast<const std::uint8_t*>(bytes_.data()));
  }

 private:
  void feed(std::string_view data) {
    inflate_.next_in = reinterpret_cast<std::uint8_t*>(const_cast<char*>(data.data()));
    inflate_.avail_in = static_cast<std::uint32_t>(data.size());
  }

  void inflate(std::size_t size) {
    inflate_.next_out = rows_.data();
    inflate_.avail_out = static_cast<std::uint32_t>(size);
    while (inflate_.avail_out > 0) inflate_some();
  }

  // Inflates up to the checksum after the last row. Data beyond the last row is ignored.
  void finish() {
    std::uint8_t more = 0;
    inflate_.next_out = &more;
    inflate_.avail_out = 1;
    while (inflate_.block_state != ISAL_BLOCK_FINISH && inflate_.avail_out > 0) inflate_some();
  }

  void inflate_some() {
    const std::uint32_t in = inflate_.avail_in, out = inflate_.avail_out;
    const isal_block_state state = inflate_.block_state;
    if (const int failed = isal_inflate(&inflate_))
      throw FileError(name_,
                      fmt::format("is damaged: its data cannot be inflated (ISA-L error {}); copy it again", failed));
    if (inflate_.avail_in < in || inflate_.avail_out < out || inflate_.block_state != state) return;
    const std::optional<Chunk> chunk = chunks_.next();
    if (!chunk || chunk->kind != "IDAT")
      throw FileError(name_,
                      fmt::format("is truncated: it ends before the last of its {} rows; copy it again", height()));
    feed(chunk->data);
  }

  const std::filesystem::path& name_;
  std::string_view bytes_;
  Chunks chunks_;
  std::size_t stride_;
  std::vector<std::uint8_t> above_, rows_;
  int first_ = 0, count_ = 0;
  inflate_state inflate_;
};

// Throws FileError for a header that the PNG specification does not allow.
void check_header(const std::optional<Chunk>& chunk, const std::filesystem::path& name) {
  if (!chunk || chunk->kind != "IHDR")
    throw FileError(name, "is damaged: its first chunk is not a header (IHDR); copy it again");
  if (chunk->data.size() != 13)
    throw FileError(name, fmt::format("is damaged: its header has {} bytes, not 13", chunk->data.size()));
  const std::uint32_t width = big_endian(chunk->data), height = big_endian(chunk->data.substr(4));
  constexpr std::uint32_t largest = largest_png_side;
  if (width < 1 || height < 1 || width > largest || height > largest)
    throw FileError(name, fmt::format("declares {}×{} texels; 1 to {} per side can be read", width, height, largest));
  const int depth = static_cast<unsigned char>(chunk->data[8]), color = static_cast<unsigned char>(chunk->data[9]);
  const bool known = (color == 0 && (depth == 1 || depth == 2 || depth == 4 || depth == 8 || depth == 16)) ||
                     (color == 3 && (depth == 1 || depth == 2 || depth == 4 || depth == 8)) ||
                     ((color == 2 || color == 4 || color == 6) && (depth == 8 || depth == 16));
  if (!known || chunk->data[10] != 0 || chunk->data[11] != 0 || static_cast<unsigned char>(chunk->data[12]) > 1)
    throw FileError(
        name, fmt::format("is damaged: its header has an invalid format (bit depth {}, colour type {}); copy it again",
                          depth, color));
}

}  // namespace

std::unique_ptr<RgbaRows> open_rgba_png(std::string_view bytes, const std::filesystem::path& name) {
  if (!bytes.starts_with("\x89PNG\r\n\x1a\n")) return nullptr;
  Chunks chunks(bytes, name);
  std::optional<Chunk> chunk = chunks.next();
  // Bit depth 8, RGBA, deflate, adaptive filters, not interlaced.
  check_header(chunk, name);
  if (chunk->data.substr(8) != std::string_view("\x08\x06\0\0\0", 5)) return nullptr;
  const std::uint32_t width = big_endian(chunk->data), height = big_endian(chunk->data.substr(4));
  for (;;) {
    chunk = chunks.next();
    if (!chunk) throw FileError(name, "is truncated: it ends before its first row; copy it again");
    if (chunk->kind == "IDAT") break;
    if (critical(chunk->kind) && chunk->kind != "PLTE") return nullptr;
  }
  return std::make_unique<RgbaPng>(static_cast<int>(width), static_cast<int>(height), bytes, chunks, chunk->data, name);
}

}  // namespace rebake
