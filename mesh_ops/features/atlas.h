#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "mesh_ops/index/texel_patches.h"
#include "mesh_ops/scene/object.h"
#include "mesh_ops/texture/texel_rows.h"

namespace rebake {

/// Texels of some sets moved closer together, in as few textures of at most `largest_side`² as they need.
struct PackedSets {
  std::vector<TextureSet> sets;
  std::uint64_t texel_area = 0;  ///< width × height over all new textures
};

/// A texture of moved texels that is not made yet, and the triangles that use it.
struct PackedPage {
  Soup soup;
  TexelRows texels;  ///< reads the sets' textures, which it keeps
};

/// A patch of a set.
struct PatchNumber {
  std::size_t set = 0, patch = 0;
  bool operator==(const PatchNumber&) const = default;
};
/// For each set, for each patch (texel_patches): whose texels it is to show, which has the same size and shows its own.
using ShownBy = std::vector<std::vector<PatchNumber>>;

/// Moves the patches of texels that triangles use, whole and bit for bit, into new textures; drops the rest. UVs follow
/// by whole texels, so nearest sampling finds the same texels. Positions, turns and the order of faces within a texture
/// are kept. Textures of another alpha code than `code` are converted (halved from plain loses the alpha's lowest bit,
/// as the published exporter does). With `shown_by` patches show others' texels, and their own are dropped. Throws
/// Error for a patch larger than `largest_side`, and for UVs outside [0, 1].
PackedSets pack(const std::vector<TextureSet>& sets, int largest_side, AlphaCode code, const ShownBy& shown_by = {});

/// As pack(), without making the textures.
std::vector<PackedPage> packed_pages(const std::vector<TextureSet>& sets, int largest_side, AlphaCode code,
                                     const ShownBy& shown_by = {});

/// The texture with its alpha stored the other way; the same pointer when it already is.
std::shared_ptr<const FeatureTexture> with_alpha_code(const std::shared_ptr<const FeatureTexture>& texture,
                                                      AlphaCode code);

/// True when all UVs of the faces lie in [0, 1], so that texels can be moved.
bool can_pack(const TextureSet& set);

}  // namespace rebake
