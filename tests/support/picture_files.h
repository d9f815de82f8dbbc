#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rebake::test {

/// Properties of a picture that OpenImageIO writes, as other programs would; the extension decides the format.
struct PictureFile {
  int width = 0, height = 0, channels = 3;
  std::string type = "uint8";  ///< type of a channel: uint8, uint16 or float
  int tile = 0;                ///< side of the tiles in pixels; 0: scan lines
  int whole_height = 0;  ///< height of the full picture, of which this is the upper part; 0: this is the full picture
};

/// Writes `pixels`: [height][width][channels], 1 is the largest integer value. Throws std::runtime_error.
void write_picture(const std::filesystem::path& path, const PictureFile& file, const std::vector<float>& pixels);

/// Exported by the module that links OpenImageIO; returns false and fills `error` on failure. Like the product, the
/// test program does not link OpenImageIO.
using WritePicture = bool (*)(const std::string& path, const PictureFile& file, const float* pixels,
                              std::string& error);
inline constexpr const char* write_picture_symbol = "rebake_test_write_picture";

}  // namespace rebake::test
