#include "editor/studies/representations/snerg_pack.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace rebake {

namespace {

using Bytes = std::array<std::uint8_t, snerg_channels>;

std::size_t block_index(const SnergScene::Size& blocks, int x, int y, int z) {
  return static_cast<std::size_t>((z * blocks[1] + y) * blocks[0] + x);
}

// Calls `use` for each block that holds a voxel, alone or in its padding.
template <class Use>
void for_blocks_of(const std::array<int, 3>& voxel, int block, const SnergScene::Size& blocks, const Use& use) {
  const auto first = [&](std::size_t a) { return std::max(0, (voxel[a] - 1) / block); };
  const auto last = [&](std::size_t a) { return std::min(blocks[a] - 1, (voxel[a] + 1) / block); };
  for (int z = first(2); z <= last(2); ++z)
    for (int y = first(1); y <= last(1); ++y)
      for (int x = first(0); x <= last(0); ++x) use(x, y, z);
}

// Whether each block is occupied.
std::vector<bool> occupied_blocks(const VoxelCells& cells, const std::vector<std::size_t>& kept, int block,
                                  const SnergScene::Size& blocks) {
  std::vector<bool> used(block_index(blocks, 0, 0, blocks[2]), false);
  for (const std::size_t cell : kept)
    for_blocks_of(cells.at[cell], block, blocks,
                  [&](int x, int y, int z) { used[block_index(blocks, x, y, z)] = true; });
  return used;
}

// Numbers of blocks of an atlas for `count` blocks: nearly a cube.
SnergScene::Size atlas_for(std::size_t count) {
  const auto wanted = static_cast<double>(std::max<std::size_t>(count, 1));
  const int x = static_cast<int>(std::ceil(std::cbrt(wanted))), y = static_cast<int>(std::ceil(std::sqrt(wanted / x)));
  // Blocks with padding are 10, 18 or 34 voxels: an even number of them makes whole pictures of four planes.
  const int z = static_cast<int>(std::ceil(wanted / x / y));
  return {x, y, z + z % 2};
}

// How many bytes the atlas and the places of blocks take.
double memory(const SnergScene::Size& atlas, int block, std::size_t blocks) {
  return 8.0 * atlas[0] * atlas[1] * atlas[2] * std::pow(block + 2, 3) + 3.0 * static_cast<double>(blocks);
}

void write_voxel(SnergScene& scene, const std::array<int, 3>& voxel, const Bytes& bytes) {
  const SnergScene::Size blocks = scene.blocks(), atlas = scene.atlas;
  const int padded = scene.block_size + 2;
  for_blocks_of(voxel, scene.block_size, blocks, [&](int x, int y, int z) {
    const auto& place = scene.block_places[block_index(blocks, x, y, z)];
    const std::array<int, 3> block{x, y, z};
    std::array<int, 3> at{};
    for (std::size_t a = 0; a < 3; ++a) at[a] = place[a] * padded + 1 + voxel[a] - block[a] * scene.block_size;
    const auto index =
        (static_cast<std::size_t>(at[2]) * static_cast<std::size_t>(atlas[1]) + static_cast<std::size_t>(at[1])) *
            static_cast<std::size_t>(atlas[0]) +
        static_cast<std::size_t>(at[0]);
    for (std::size_t c = 0; c < 3; ++c) scene.colors[4 * index + c] = bytes[c];
    scene.colors[4 * index + 3] = bytes[snerg_alpha];
    for (std::size_t c = 0; c < 4; ++c) scene.features[4 * index + c] = bytes[3 + c];
  });
}

}  // namespace

SnergScene pack_snerg(const VoxelCells& cells, const std::function<const float*(std::size_t)>& values,
                      const SnergDecoder& decoder) {
  std::vector<std::size_t> kept;
  for (std::size_t cell = 0; cell < cells.count(); ++cell)
    if (const float* value = values(cell); value != nullptr && value[snerg_alpha] >= 0.5F / 255) kept.push_back(cell);
  SnergScene scene;
  scene.voxel_size = cells.voxel;
  scene.grid = cells.size;
  scene.min = cells.min;
  scene.decoder = decoder;
  double least = std::numeric_limits<double>::infinity();
  std::vector<bool> used;
  for (const int block : {8, 16, 32}) {
    SnergScene::Size blocks{};
    for (std::size_t a = 0; a < 3; ++a) blocks[a] = (scene.grid[a] + block - 1) / block;
    std::vector<bool> occupied = occupied_blocks(cells, kept, block, blocks);
    const auto count = static_cast<std::size_t>(std::count(occupied.begin(), occupied.end(), true));
    const SnergScene::Size atlas = atlas_for(count);
    if (const double bytes = memory(atlas, block, occupied.size());
        bytes < least && *std::max_element(atlas.begin(), atlas.end()) < 255) {
      least = bytes;
      scene.block_size = block;
      scene.atlas_blocks = atlas;
      used = std::move(occupied);
    }
  }
  scene.atlas = scene.atlas_needed();
  scene.block_places.assign(used.size(), {255, 255, 255});
  int next = 0;
  for (std::size_t b = 0; b < used.size(); ++b) {
    if (!used[b]) continue;
    const auto [x, y, z] = scene.atlas_blocks;
    scene.block_places[b] = {static_cast<std::uint8_t>(next % x), static_cast<std::uint8_t>(next / x % y),
                             static_cast<std::uint8_t>(next / (x * y))};
    ++next;
  }
  const SnergScene::Size atlas = scene.atlas;
  const auto texels =
      static_cast<std::size_t>(atlas[0]) * static_cast<std::size_t>(atlas[1]) * static_cast<std::size_t>(atlas[2]);
  scene.colors.assign(4 * texels, 0);
  scene.features.assign(4 * texels, 0);
  for (const std::size_t cell : kept) {
    const float* value = values(cell);
    Bytes bytes{};
    for (std::size_t c = 0; c < snerg_channels; ++c)
      bytes[c] = static_cast<std::uint8_t>(std::lround(255 * std::clamp(value[c], 0.0F, 1.0F)));
    write_voxel(scene, cells.at[cell], bytes);
  }
  return scene;
}

}  // namespace rebake
