#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "mesh_ops/formats/images/png_writer.h"
#include "mesh_ops/texture/texel_rows.h"

namespace rebake {

/// Decodes the two feature images of a texture set from their files' bytes; texels are not altered. Both must be 8-bit
/// RGBA PNGs of the same size, at most 16384² texels. Throws FileError naming the file. `passed(image, count)` is
/// called when the first `count` bytes of an image's file will not be read again.
FeatureTexture read_feature_pngs(std::string_view feat0, const std::filesystem::path& name0, std::string_view feat1,
                                 const std::filesystem::path& name1, AlphaCode code,
                                 const std::function<void(int image, std::size_t count)>& passed = {});

/// Encodes both feature images together, one row of tiles at a time. A null sink skips its image. Writes no
/// colour-space chunks, since browsers would convert texels by them.
void write_feature_pngs(const TexelRows& texels, const PngEncoder::Sink& feat0, const PngEncoder::Sink& feat1);

/// Encodes feature image 0 or 1 alone.
std::string write_feature_png(const FeatureTexture& texture, int image);

}  // namespace rebake
