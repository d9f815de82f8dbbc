#pragma once

#include <array>
#include <optional>
#include <vector>

#include "mesh_ops/fill/hole_patch.h"

namespace rebake {

/// Features of a patch's vertices in bytes, 0 … 255, as in both images.
using PatchFeatures = std::vector<std::array<double, 8>>;

/// Features for all vertices of a patch from those of its border, by a harmonic interpolation with weights 1 / edge
/// length: they stay between the border's. `border`: per point of the loop; nullopt where no texel is opaque. Empty if
/// no point has features.
PatchFeatures harmonic_features(const HolePatch& patch,
                                const std::vector<std::optional<std::array<double, 8>>>& border);

/// A texture set for patches: each triangle gets a square of texels of its own, with the corners at the centres of
/// corner texels. `texel`: side of a texel in object units; larger if the texture would be higher than 16384 texels.
/// All texels are opaque. Appends the number of its patch per triangle to `patch_of`.
TextureSet textured_patches(const std::vector<HolePatch>& patches, const std::vector<PatchFeatures>& features,
                            double texel, AlphaCode code, std::vector<std::size_t>& patch_of);

}  // namespace rebake
