#pragma once

#include <vector>

#include "render/image.h"

namespace rebake {

/// Pixels per degree of the usual viewing conditions of FLIP: a 0.7 m wide screen of 3840 pixels at 0.7 m.
inline constexpr double usual_pixels_per_degree = 67.02;

/// Perceived difference of each pixel, 0 … 1, when both pictures alternate: LDR-FLIP (Andersson et al. 2020). Throws
/// Error if their sizes differ.
std::vector<double> flip_map(const Image& reference, const Image& test,
                             double pixels_per_degree = usual_pixels_per_degree);

}  // namespace rebake
