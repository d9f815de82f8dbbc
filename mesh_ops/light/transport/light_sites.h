#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mesh_ops/light/transport/light_chart.h"
#include "mesh_ops/scene/object.h"

namespace rebake {

/// A surface point that receives light, as baked or as edited.
struct LightSite {
  Vec3 position;
  Vec3 normal;                   ///< unit and smooth over the surface; zero for triangles without area
  Vec3 tangent;                  ///< unit, perpendicular to the normal; follows the surface when it is bent
  std::array<double, 2> offset;  ///< distance above the surface at which rays start, per side; [0]: side of the normal
};

/// Sites at all nodes of an object's light charts, in the order of texture sets and nodes.
struct LightSites {
  std::vector<std::size_t> first;   ///< first site of each texture set, and the total
  std::vector<std::uint32_t> body;  ///< per site: body number
  std::vector<std::uint32_t> part;  ///< per site: connected component (Components)
  std::vector<LightSite> baked;     ///< per site: as baked, in the body's space
  std::vector<LightSite> now;       ///< per site: as edited, in object space
  std::size_t size() const { return now.size(); }
};
LightSites light_sites(const BakedObject& object, const std::vector<std::shared_ptr<const LightChart>>& charts);

}  // namespace rebake
