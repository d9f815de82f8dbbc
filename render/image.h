#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "mesh_ops/base/source_guard.h"

namespace rebake {

/// An 8-bit RGB picture in display colours, row 0 at the top.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;  ///< width × height × 3 bytes, row by row
  bool operator==(const Image&) const = default;
};

/// Reads a picture file of at most 32768 × 32768 pixels; drops alpha and expands grey to RGB. Throws FileError.
Image read_image(const std::filesystem::path& path);
/// Throws FileError if write_png() would reject the path: its extension is that of another picture format, or `guard`
/// protects it. For a check before expensive work.
void check_png_path(const std::filesystem::path& path, const SourceGuard& guard);
/// Writes a PNG file atomically. Throws FileError, also if `guard` protects the path.
void write_png(const Image& image, const std::filesystem::path& path, const SourceGuard& guard);

}  // namespace rebake
