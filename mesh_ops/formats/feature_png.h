#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "mesh_ops/texture/texels.h"

namespace rebake {

/// Decodes the two feature images of a texture set from their files' bytes; texels are kept byte for byte. Both must be
/// 8-bit RGBA PNGs of the same size, at most 16384² texels. Throws FileError naming the file.
FeatureTexture read_feature_pngs(std::string_view feat0, const std::filesystem::path& name0, std::string_view feat1,
                                 const std::filesystem::path& name1, AlphaCode code);

/// Encodes feature image 0 or 1. No colour chunks, since browsers would alter texels by them.
std::string write_feature_png(const FeatureTexture& texture, int image);

}  // namespace rebake
