#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh_ops/base/types.h"

namespace rebake {

/// The network of a SNeRG scene, evaluated once per ray. Inputs: the direction's positional encoding (27), colour (3),
/// features (4). Hidden layers are rectified, the output passes the logistic function and is added to the colour.
struct SnergDecoder {
  static constexpr int encoding = 27, inputs = encoding + 3 + 4;
  Eigen::MatrixXd weights0, weights1, weights2;  ///< [input][output]
  Eigen::VectorXd bias0, bias1, bias2;
};

/// Positional encoding of a unit direction: itself, then sines and cosines of 1, 2, 4 and 8 times its components.
std::array<double, SnergDecoder::encoding> encoded_direction(const Vec3& direction);

/// A sparse neural radiance grid (Hedman et al. 2021), as published for its web viewer. A grid of voxels is divided
/// into blocks; occupied blocks lie in an atlas, each with one voxel of padding on all sides. Voxel values are sampled
/// trilinearly, at steps of one voxel: C += T·rgb, F += T·features, T *= 1 − α. The picture is
/// C + T·white + network(direction, C + T·white, F).
struct SnergScene {
  using Size = std::array<int, 3>;
  double voxel_size = 0;  ///< scene units
  int block_size = 0;     ///< voxels per side of a block, without padding
  Size grid{};            ///< voxels
  Vec3 min = Vec3::Zero();
  Mat3 world_from_opengl = Mat3::Identity();  ///< rotates directions for the network
  Size atlas_blocks{};
  Size atlas{};                                           ///< voxels; at least atlas_blocks · (block_size + 2)
  std::vector<std::array<std::uint8_t, 3>> block_places;  ///< per block, x fastest: its place in the atlas; 255: empty
  std::vector<std::uint8_t> colors;                       ///< RGBA per voxel of the atlas, premultiplied, x fastest
  std::vector<std::uint8_t> features;                     ///< 4 per voxel of the atlas, premultiplied
  SnergDecoder decoder;

  Size blocks() const;        ///< numbers of blocks of the grid
  Size atlas_needed() const;  ///< atlas_blocks · (block_size + 2)
};

}  // namespace rebake
