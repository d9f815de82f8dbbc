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
  std::vector<std::uint8_t> rgb;  ///< width × height × 3
  bool operator==(const Image&) const = default;
};

/// Throws FileError. Alpha, where there is one, is dropped; grey becomes RGB.
Image read_image(const std::filesystem::path& path);
/// Throws FileError when write_png would refuse the path: its name promises another picture format, or `guard` protects
/// it. For asking before the work.
void check_png_path(const std::filesystem::path& path, const SourceGuard& guard);
/// Writes a PNG, whole or not at all. Throws FileError; `guard` says where nothing may be written.
void write_png(const Image& image, const std::filesystem::path& path, const SourceGuard& guard);

}  // namespace rebake
