#pragma once

#include <span>
#include <vector>

#include "mesh_ops/base/types.h"

namespace rebake {

// Opacities, weights and the losses on them, in double, with their derivatives. Hits of a ray are sorted from near to
// far.

/// Weights of a ray's hits: w_k = α_k Π_{l<k} (1 − α_l). `before`: the products, the shares of light that reach each
/// hit.
struct RayWeights {
  std::vector<double> weights, before;
  double through = 1;  ///< share of light that passes all hits: 1 − Σ w
};
void set_weights(std::span<const double> opacities, RayWeights& result);
/// Hits that less light reaches are not shaded.
inline constexpr double least_light = 1e-3;

/// Derivatives of a loss by the opacities, for those by the weights and by `through`. No division: opacities may be 1.
void opacity_slopes(std::span<const double> opacities, const RayWeights& at, std::span<const double> weight_slopes,
                    double through_slope, std::span<double> slopes);

/// Colour of a ray whose hits have these colours, before a background.
Vec3 ray_color(const RayWeights& weights, std::span<const Vec3> colors, const Vec3& background);
/// Derivatives of a loss by the hits' colours and opacities, for `slope` by the colour of the ray.
void ray_color_slopes(std::span<const double> opacities, const RayWeights& weights, std::span<const Vec3> colors,
                      const Vec3& background, const Vec3& slope, std::span<Vec3> by_color,
                      std::span<double> by_opacity);

/// Opacity as it is drawn: 1 − ε above ½, else ε, with ε = 1e-5. Its derivative by α counts as 1 (straight-through).
inline double binary_opacity(double opacity) { return opacity > 0.5 ? 1 - 1e-5 : 1e-5; }

/// Distortion of a ray (Barron et al., Mip-NeRF 360, 2022): Σ_ij w_i w_j |x_i − x_j| + Σ (w_i² + w_{i+1}²) Δx_i / 6, as
/// in MobileNeRF's code. Adds `scale` times its derivatives by the weights. `places`: ascending.
double distortion(std::span<const double> weights, std::span<const double> places, double scale,
                  std::span<double> slopes);

}  // namespace rebake
