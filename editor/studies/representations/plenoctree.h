#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh_ops/base/types.h"

namespace rebake {

/// A sparse octree of densities and spherical harmonics (Yu et al. 2021, svox). A point p has tree coordinates
/// offset + scale·p in the unit cube. Light through a leaf: α = 1 − exp(−density·length in scene units); colour =
/// logistic(Σ coefficients · harmonics(direction)); the background is white.
struct PlenOctree {
  int basis = 9;  ///< spherical harmonics per colour channel: 1, 4, 9 or 16
  Vec3 offset = Vec3::Zero(), scale = Vec3::Ones();
  /// Per node, 8 children in the order 4x + 2y + z: offset from this node to the child node; 0: a leaf.
  std::vector<std::array<std::int32_t, 8>> children;
  /// Per node and child: `basis` coefficients each of red, green and blue, then the density.
  std::vector<Eigen::half> data;

  std::size_t record() const { return static_cast<std::size_t>(3 * basis) + 1; }  ///< numbers per leaf
  const Eigen::half* leaf(std::size_t node, std::size_t child) const { return &data[(node * 8 + child) * record()]; }
  Eigen::half* leaf(std::size_t node, std::size_t child) { return &data[(node * 8 + child) * record()]; }
};

/// Real spherical harmonics of a unit direction, in the order and with the signs of svox; those of degree 3 too.
std::array<double, 16> tree_harmonics(const Vec3& direction);

}  // namespace rebake
