#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// A coarse grid of light over a texture set: each patch of texels has its own nodes, so that light interpolated
/// between nodes of one never takes any of another.
struct LightChart {
  Soup::Uvs uvs;                        ///< that it was made of
  int width = 0, height = 0;            ///< of the texture whose texels are the nodes
  std::vector<Eigen::Vector2f> places;  ///< of each vertex in it, in texels, y down; nodes lie at whole numbers + ½

  /// A node that opaque texels take light from: a point of a triangle.
  struct Node {
    std::uint32_t texel;  ///< y · width + x
    std::uint32_t face;   ///< of the set
    Eigen::Vector3f weights;
    std::uint32_t patch = 0;  ///< number of its patch: texels beside each other may be of different ones
  };
  std::vector<Node> nodes;

  std::size_t texel_count() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
};

/// Nodes at most `spacing` ≥ 1 texels apart, at least two across each patch.
LightChart light_chart(const TextureSet& set, double spacing);

}  // namespace rebake
