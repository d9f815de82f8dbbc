#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "mesh_ops/formats/png_writer.h"
#include "mesh_ops/texture/texel_rows.h"

namespace rebake {

/// Decodes the two feature images of a texture set from their files' bytes; texels are kept byte for byte. Both must be
/// 8-bit RGBA PNGs of the same size, at most 16384² texels. Throws FileError naming the file.
/// `passed(image, count)` is told how many of a file's first bytes are not read again.
FeatureTexture read_feature_pngs(std::string_view feat0, const std::filesystem::path& name0, std::string_view feat1,
                                 const std::filesystem::path& name1, AlphaCode code,
                                 const std::function<void(int image, std::size_t count)>& passed = {});

/// Encodes both feature images side by side, a row of tiles at a time. A null sink leaves its image out. No colour
/// chunks, since browsers would alter texels by them.
void write_feature_pngs(const TexelRows& texels, const PngEncoder::Sink& feat0, const PngEncoder::Sink& feat1);

/// Feature image 0 or 1 alone.
std::string write_feature_png(const FeatureTexture& texture, int image);

}  // namespace rebake
