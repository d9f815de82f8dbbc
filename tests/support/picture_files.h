#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rebake::test {

/// A picture to be written as others write them, by OpenImageIO, in the format that its name says.
struct PictureFile {
  int width = 0, height = 0, channels = 3;
  std::string type = "uint8";  ///< of a channel: uint8, uint16 or float
  int tile = 0;                ///< pixels a side of its tiles; 0: rows
  int whole_height = 0;        ///< of the picture that this is the upper part of; 0: it is whole
};

/// `pixels` are width × height × channels, 1 is the largest whole number. Throws std::runtime_error.
void write_picture(const std::filesystem::path& path, const PictureFile& file, const std::vector<float>& pixels);

/// What the module that knows OpenImageIO gives; false with `error` filled. The program of the tests itself is not
/// linked to it, as the product is not.
using WritePicture = bool (*)(const std::string& path, const PictureFile& file, const float* pixels,
                              std::string& error);
inline constexpr const char* write_picture_symbol = "rebake_test_write_picture";

}  // namespace rebake::test
