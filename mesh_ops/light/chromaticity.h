#pragma once

#include <cstdint>
#include <vector>

#include "mesh_ops/scene/light.h"

namespace rebake {

/// Surfaces that may be of one material: a number for each linear colour, the same for colours of much the same
/// chromaticity, so wide that a warm sun and a blue sky do not tell lit from shaded ones. The most common chromaticity
/// takes what is near it and is 0, then the most common of the rest.
std::vector<std::uint32_t> chromaticity_clusters(const std::vector<Radiance>& colors);

}  // namespace rebake
