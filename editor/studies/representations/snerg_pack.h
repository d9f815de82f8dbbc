#pragma once

#include <array>
#include <cstddef>
#include <functional>

#include "editor/studies/representations/snerg_scene.h"
#include "editor/studies/representations/voxel_cells.h"

namespace rebake {

/// Values of a voxel: premultiplied colour (3) and features (4), and opacity.
inline constexpr std::size_t snerg_channels = 8, snerg_alpha = 7;
using SnergValues = std::array<float, snerg_channels>;

/// Quantises voxels and packs the occupied blocks into an atlas, with blocks of 8, 16 or 32 voxels, whichever takes
/// least memory. `values`: snerg_channels numbers of an occupied cell, 0 … 1; null: nothing there.
SnergScene pack_snerg(const VoxelCells& cells, const std::function<const float*(std::size_t cell)>& values,
                      const SnergDecoder& decoder);

}  // namespace rebake
