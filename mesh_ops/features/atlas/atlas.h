#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "mesh_ops/index/texel_patches.h"
#include "mesh_ops/scene/object.h"
#include "mesh_ops/texture/texel_rows.h"

namespace rebake {

/// Texture sets repacked into as few textures of at most `largest_side`² as possible.
struct PackedSets {
  std::vector<TextureSet> sets;
  std::vector<TexelPatches> patches = {};  ///< per new set: the moved patches, in its texels
  std::uint64_t texel_area = 0;            ///< width × height over all new textures
};

/// A repacked texture before its creation, with the triangles that use it.
struct PackedPage {
  Soup soup;
  TexelRows texels;  ///< reads from the sets' textures, which it owns
  /// The moved patches, in the page's texels. They must not be found again from UVs: a UV on the border of a patch lies
  /// in a texel of its neighbour.
  TexelPatches patches = {};
};

/// Identifies a patch of texels (texel_patches) in a list of texture sets.
struct PatchNumber {
  std::size_t set = 0, patch = 0;
  bool operator==(const PatchNumber&) const = default;
};
/// Per set and patch (texel_patches): the representative whose texels it uses, of the same size.
using PatchRepresentatives = std::vector<std::vector<PatchNumber>>;

/// Moves the used patches of texels bit for bit into new textures and drops the rest. UVs move by whole texels, so
/// nearest sampling finds the same texels. Positions, rotations and the order of faces within a texture are preserved.
/// Textures with another alpha code are converted to `code`; plain to halved loses the lowest bit of alpha, as in the
/// published exporter. `representative_of` replaces patches by representatives. Throws Error for a patch larger than
/// `largest_side` and for UVs outside [0, 1].
PackedSets pack(const std::vector<TextureSet>& sets, int largest_side, AlphaCode code,
                const PatchRepresentatives& representative_of = {});

/// As pack(), without creating the textures.
std::vector<PackedPage> packed_pages(const std::vector<TextureSet>& sets, int largest_side, AlphaCode code,
                                     const PatchRepresentatives& representative_of = {});

/// The texture converted to an alpha code; the same pointer if it has it already.
std::shared_ptr<const FeatureTexture> with_alpha_code(const std::shared_ptr<const FeatureTexture>& texture,
                                                      AlphaCode code);

/// Whether all UVs of the faces lie in [0, 1], so that texels can be moved.
bool can_pack(const TextureSet& set);

}  // namespace rebake
