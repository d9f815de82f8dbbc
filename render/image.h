#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "mesh_ops/base/source_guard.h"

namespace rebake {

/// An 8-bit picture in display colours, row 0 at the top.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;      ///< width × height × 3 bytes, row by row; not multiplied by alpha
  std::vector<std::uint8_t> alpha{};  ///< width × height bytes; empty: opaque
  bool operator==(const Image&) const = default;
};

enum class AlphaChannel { drop, keep };
/// Reads a picture file of at most 32768 × 32768 pixels; expands grey to RGB; the linear light of OpenEXR becomes
/// display colours, without alpha. Throws FileError.
Image read_image(const std::filesystem::path& path, AlphaChannel alpha = AlphaChannel::drop);
/// Extensions of the formats that write_picture() writes: ".png, .jpg, …".
std::string picture_extensions();
/// Throws FileError if write_picture() would reject the path: its extension is that of a format that cannot be written,
/// `guard` protects it, or it exists and is not a picture. For a check before expensive work.
void check_picture_path(const std::filesystem::path& path, const SourceGuard& guard);
/// Whether a file begins as a picture of a known format.
bool is_picture_file(const std::filesystem::path& path);
/// Whether a file is a picture that Rebake wrote and nobody changed: a PNG, JPEG, WebP, OpenEXR or
/// SVG with its mark (picture_mark.h).
bool is_rendered_picture(const std::filesystem::path& path);
/// Whether write_picture() can write alpha into a file of this name: not into JPEGs.
bool holds_alpha(const std::filesystem::path& path);
/// Writes a picture file atomically, with alpha if the picture has it and the format holds it: PNG and WebP without
/// loss, JPEG with quality 95, or OpenEXR with linear light (IEC 61966-2-1) in half floats, multiplied by alpha.
/// Unknown extensions mean PNG. Throws FileError, also if `guard` protects the path.
void write_picture(const Image& image, const std::filesystem::path& path, const SourceGuard& guard);

}  // namespace rebake
