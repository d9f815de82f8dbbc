#pragma once

#include <cstdint>
#include <vector>

#include "mesh_ops/scene/scene_light.h"

namespace rebake {

/// Clusters linear colours by chromaticity, as candidates for one material. Returns a cluster number per colour.
/// Clusters are wide enough that a warm sun and a blue sky do not separate lit from shaded points. Cluster 0 is around
/// the most common chromaticity, cluster 1 around the most common of the rest, and so on.
std::vector<std::uint32_t> chromaticity_clusters(const std::vector<Radiance>& colors);

}  // namespace rebake
