#pragma once

#include <memory>
#include <vector>

#include "mesh_ops/light/irradiance.h"

namespace rebake {

/// What a change of light does to the colours of a texture set: linear colour → max(0, gain · colour + offset), a
/// channel, interpolated between the chart's nodes.
struct LightMap {
  std::shared_ptr<const LightChart> chart;
  std::vector<Eigen::Vector3f> gain;    ///< a texel of the chart
  std::vector<Eigen::Vector3f> offset;  ///< likewise; empty where all are 0
};

/// Values of a chart's texels at a place (LightChart::places), bilinearly between their centres, as the GPU does.
Eigen::Vector3f interpolated(const LightChart& chart, const std::vector<Eigen::Vector3f>& values,
                             const Eigen::Vector2f& place);

/// Mean colour of each site over the directions it is seen from, in linear light: `facing` is the share of its first
/// side in what is seen of it.
std::vector<Radiance> site_colors(const BakedObject& object,
                                  const std::vector<std::shared_ptr<const LightChart>>& charts, const LightSites& sites,
                                  const std::vector<float>& facing);

/// How much each site shows of its first side, 1, ½ or 0, the same for each part that hangs together: by which side is
/// open and, where both are, by which side's light explains the colours.
std::vector<float> facing_of(const LightSites& sites, const std::vector<SiteLight>& baked,
                             const std::vector<Radiance>& colors);

/// The sides that show by that, as traced_light wants them, and what is seen of their light.
std::uint8_t shown_sides(float facing);
Radiance shown_light(const SiteLight& lit, float facing);

/// c' = max(0, c + ρ (E₁ − E₀)) with ρ = (c E₀ + λ ρ_part) / (E₀² + λ): linear in c, exactly the identity where E₁ =
/// E₀. `before` and `after` are irradiances over π, λ is (0.3 · the object's common irradiance)². A map a texture set;
/// null where nothing changes.
std::vector<std::shared_ptr<const LightMap>> light_maps(const std::vector<std::shared_ptr<const LightChart>>& charts,
                                                        const LightSites& sites, const std::vector<Radiance>& colors,
                                                        const std::vector<Radiance>& before,
                                                        const std::vector<Radiance>& after);

}  // namespace rebake
