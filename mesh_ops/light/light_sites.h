#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mesh_ops/light/light_chart.h"
#include "mesh_ops/scene/object.h"

namespace rebake {

/// A point of a surface that light falls on, as it was when the light was baked or as it is.
struct LightSite {
  Vec3 position;
  Vec3 normal;                   ///< of length 1 and smooth over the surface; zero where there is no area
  Vec3 tangent;                  ///< of length 1, across the normal; goes with the surface when that is bent
  std::array<double, 2> offset;  ///< how far above it rays start, to its two sides: [0] where the normal points
};

/// The points of an object's light charts, set by set, node by node.
struct LightSites {
  std::vector<std::size_t> first;   ///< of each set, and the end
  std::vector<std::uint32_t> body;  ///< number of each site's body
  std::vector<std::uint32_t> part;  ///< of its part that hangs together (Components)
  std::vector<LightSite> baked;     ///< in its body's own space
  std::vector<LightSite> now;       ///< in the object's space
  std::size_t size() const { return now.size(); }
};
LightSites light_sites(const BakedObject& object, const std::vector<std::shared_ptr<const LightChart>>& charts);

}  // namespace rebake
