#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// A coarse grid of light nodes over a texture set. Each patch of texels has its own nodes, so light is never
/// interpolated across patches.
struct LightChart {
  Soup::Uvs uvs;                        ///< UV array of the texture set that the chart was built for
  int width = 0, height = 0;            ///< size of the grid in nodes
  std::vector<Eigen::Vector2f> places;  ///< per vertex: position in the grid, y down; nodes are at integers + ½

  /// A node that opaque texels use: a point of a triangle.
  struct Node {
    std::uint32_t texel;      ///< index in the grid: y · width + x
    std::uint32_t face;       ///< face of the texture set
    Eigen::Vector3f weights;  ///< barycentric weights of the face's corners
    std::uint32_t patch = 0;  ///< patch number; adjacent texels may belong to different patches
  };
  std::vector<Node> nodes;

  std::size_t texel_count() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
};

/// Nodes at most `spacing` ≥ 1 texels apart, at least two across each patch.
LightChart light_chart(const TextureSet& set, double spacing);

}  // namespace rebake
