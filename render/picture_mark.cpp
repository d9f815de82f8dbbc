#include "render/picture_mark.h"

#include <zlib.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <optional>
#include <string_view>
#include <utility>

#include "mesh_ops/base/hash.h"

namespace rebake {

namespace {

using namespace std::string_view_literals;

constexpr auto name = "Rebake "sv, blank = "0000000000000000"sv;
constexpr auto png_signature = "\x89PNG"sv, jpeg_start = "\xff\xd8"sv, openexr_signature = "\x76\x2f\x31\x01"sv;
constexpr std::size_t checksum_size = 4;
constexpr std::size_t header_size = 1 << 16;  // of files; attributes of OpenEXR may be long

// Offset of the hash's digits, and whether a checksum of their chunk follows them.
struct Place {
  std::size_t digits;
  bool checksum;
};

// The text chunk that names the program (PNG, section 11.3.4.3), after the signature and the chunk IHDR.
constexpr std::size_t after_header = 8 + 25;
constexpr auto png_keyword = "tEXtSoftware\0"sv;
// The comment (JPEG, section B.2.4.5), whose length includes that of the field.
constexpr auto jpeg_comment = "\xff\xfe\0\x19"sv;
static_assert(jpeg_comment[3] == name.size() + blank.size() + 2);
// An attribute of OpenEXR: name, type, size of the value.
constexpr auto openexr_attribute = "oftware\0string\0\x17\0\0\0"sv;
static_assert(openexr_attribute[15] == name.size() + blank.size());

// A comment after the root element (XML 1.0, section 2.1).
constexpr auto svg_start = "<?xml"sv, svg_comment = "<!-- "sv, svg_end = " -->\n"sv;

template <int bytes>
std::string little_endian(std::size_t value) {
  std::string text;
  for (int k = 0; k < bytes; ++k) text += static_cast<char>(value >> 8 * k & 255U);
  return text;
}

std::string big_endian(std::uint64_t value) {
  std::string text;
  for (int shift = 24; shift >= 0; shift -= 8) text += static_cast<char>(value >> shift & 255U);
  return text;
}

std::optional<Place> place_in(std::string_view bytes) {
  const auto after = [&](std::size_t at, std::string_view text, bool checksum) -> std::optional<Place> {
    if (at > bytes.size()) return std::nullopt;
    const std::string_view rest = bytes.substr(at);
    if (rest.size() < text.size() + name.size() + blank.size() + (checksum ? checksum_size : 0)) return std::nullopt;
    if (!rest.starts_with(text) || rest.substr(text.size(), name.size()) != name) return std::nullopt;
    return Place{at + text.size() + name.size(), checksum};
  };
  if (bytes.starts_with(png_signature)) return after(after_header + 4, png_keyword, true);
  if (bytes.starts_with(jpeg_start)) return after(jpeg_start.size(), jpeg_comment, false);
  if (bytes.starts_with(openexr_signature)) {
    return after(bytes.substr(0, header_size).find(openexr_attribute), openexr_attribute, false);
  }
  if (bytes.starts_with(svg_start)) {
    constexpr std::size_t size = svg_comment.size() + name.size() + blank.size() + svg_end.size();
    if (bytes.size() < size || !bytes.ends_with(svg_end)) return std::nullopt;
    return after(bytes.size() - size, svg_comment, false);
  }
  constexpr std::size_t end = name.size() + blank.size() + 1;
  if (bytes.starts_with("RIFF"sv) && bytes.size() > end) return after(bytes.size() - end, ""sv, false);
  return std::nullopt;
}

// The bytes with the hash of all others, and its checksum, in place.
std::string sealed(std::string bytes, const Place& place) {
  const std::string_view all = bytes;
  ContentHash hash;
  hash.add(all.substr(0, place.digits));
  hash.add(all.substr(place.digits + blank.size() + (place.checksum ? checksum_size : 0)));
  bytes.replace(place.digits, blank.size(), hash_text(hash.value()));
  if (place.checksum) {
    const std::size_t first = after_header + 4, count = place.digits + blank.size() - first;
    const uLong sum = crc32(0, reinterpret_cast<const Bytef*>(&bytes[first]), static_cast<uInt>(count));
    bytes.replace(first + count, checksum_size, big_endian(sum));
  }
  return bytes;
}

std::string with_text_chunk(const std::string& png) {
  const std::string chunk = std::string(png_keyword) + std::string(name) + std::string(blank);
  return png.substr(0, after_header) + big_endian(chunk.size() - 4) + chunk + std::string(checksum_size, '\0') +
         png.substr(after_header);
}

std::string with_comment(const std::string& jpeg) {
  return std::string(jpeg_start) + std::string(jpeg_comment) + std::string(name) + std::string(blank) +
         jpeg.substr(jpeg_start.size());
}

std::string with_xml_comment(const std::string& svg) {
  return svg + std::string(svg_comment) + std::string(name) + std::string(blank) + std::string(svg_end);
}

// With metadata (WebP container specification, sections "Extended File Format" and "Metadata"; Exif 2.32, section 4.6).
std::string with_exif(const std::string& webp, int width, int height, bool has_alpha) {
  const auto chunk = [](const std::string& kind, const std::string& bytes) {
    return kind + little_endian<4>(bytes.size()) + bytes + std::string(bytes.size() % 2, '\0');
  };
  constexpr std::size_t software = 0x131, ascii = 2;
  const std::string text = std::string(name) + std::string(blank) + '\0', header("II*\0", 4);
  const std::size_t first_table = 8, after_table = first_table + 2 + 12 + 4;
  const std::string exif = header + little_endian<4>(first_table) + little_endian<2>(1) + little_endian<2>(software) +
                           little_endian<2>(ascii) + little_endian<4>(text.size()) + little_endian<4>(after_table) +
                           little_endian<4>(0) + text;
  constexpr std::size_t exif_flag = 0x08, alpha_flag = 0x10, container_header = 12;
  const std::string extended = little_endian<4>(exif_flag | (has_alpha ? alpha_flag : 0)) +
                               little_endian<3>(static_cast<std::size_t>(width - 1)) +
                               little_endian<3>(static_cast<std::size_t>(height - 1));
  const std::string body = "WEBP" + chunk("VP8X", extended) + webp.substr(container_header) + chunk("EXIF", exif);
  return "RIFF" + little_endian<4>(body.size()) + body;
}

}  // namespace

const std::pair<std::string, std::string> openexr_mark{"Software", std::string(name) + std::string(blank)};

std::string with_mark(const std::string& bytes, int width, int height, bool has_alpha) {
  std::string marked = bytes.starts_with(png_signature) && bytes.size() >= after_header ? with_text_chunk(bytes)
                       : bytes.starts_with(jpeg_start)                                  ? with_comment(bytes)
                       : bytes.starts_with("RIFF"sv)  ? with_exif(bytes, width, height, has_alpha)
                       : bytes.starts_with(svg_start) ? with_xml_comment(bytes)
                                                      : bytes;
  const std::optional<Place> place = place_in(marked);
  return place ? sealed(std::move(marked), *place) : marked;
}

std::string with_mark(const std::string& png_or_svg) { return with_mark(png_or_svg, 0, 0, false); }

bool has_mark(const std::filesystem::path& file) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (error || !std::filesystem::is_regular_file(file, error)) return false;
  std::ifstream input(file, std::ios::binary);
  std::string bytes;
  const auto read_up_to = [&](std::uintmax_t count) {
    const std::size_t before = bytes.size();
    bytes.resize(static_cast<std::size_t>(count));
    return static_cast<bool>(input.read(bytes.data() + before, static_cast<std::streamsize>(bytes.size() - before)));
  };
  // Photographs may be large: the rest is read only if the mark can be in it.
  if (!read_up_to(std::min<std::uintmax_t>(size, header_size))) return false;
  const bool at_end =
      bytes.starts_with(svg_start) || (bytes.starts_with("RIFF"sv) && bytes.substr(0, 12).ends_with("WEBP"sv));
  if (!at_end && !place_in(bytes)) return false;
  if (!read_up_to(size)) return false;
  const std::optional<Place> place = place_in(bytes);
  return place && sealed(bytes, *place) == bytes;
}

}  // namespace rebake
