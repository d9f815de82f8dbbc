#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "mesh_ops/formats/images/png_writer.h"
#include "mesh_ops/scene/object.h"
#include "mesh_ops/texture/texel_rows.h"

namespace rebake {

/// The texels of a texture set, as read_feature_images() finds them.
struct FeatureImages {
  FeatureTexture texels;
  std::vector<std::string> assumptions;  ///< sentences about images that are not 8-bit RGBA
  std::array<bool, 2> needs_repair{};    ///< whether other programs read different texels; exports must not copy it
};

/// Decodes the two feature images of a texture set from their files' bytes: PNG or WebP of the same size, at most
/// 16384² texels. 8-bit RGBA texels are not altered; others are changed, which the assumptions list. Grey becomes R = G
/// = B, a missing alpha 255, and 16 bits are rounded to 8, but a red byte of feat0 never to 0, which would make a hole.
/// Throws FileError naming the file. `passed(image, count)` is called when the first `count` bytes of an image's file
/// will not be read again.
FeatureImages read_feature_images(std::string_view feat0, const std::filesystem::path& name0, std::string_view feat1,
                                  const std::filesystem::path& name1, AlphaCode code, const Dialect& dialect = {},
                                  const std::function<void(int image, std::size_t count)>& passed = {});

/// Encodes both feature images together, one row of tiles at a time. A null sink skips its image. Writes no
/// colour-space chunks, since browsers would convert texels by them.
void write_feature_pngs(const TexelRows& texels, const PngEncoder::Sink& feat0, const PngEncoder::Sink& feat1);

/// Encodes feature image 0 or 1 alone.
std::string write_feature_png(const FeatureTexture& texture, int image);

}  // namespace rebake
