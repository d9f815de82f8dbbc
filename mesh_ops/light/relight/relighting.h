#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "mesh_ops/light/transport/gloss.h"

namespace rebake {

/// Correction of the colours of a texture set: linear colour → max(0, gain · colour + offset) per channel, interpolated
/// between the chart's nodes.
struct LightMap {
  std::shared_ptr<const LightChart> chart;
  std::vector<Eigen::Vector3f> gain;      ///< per chart texel
  std::vector<Eigen::Vector3f> offset;    ///< per chart texel; empty if all are 0
  std::shared_ptr<const GlossMap> gloss;  ///< change of the specular reflection; null if there is none
};

/// Bilinear interpolation of a chart's texel values at a place (LightChart::places), as the GPU does it.
template <class Value>
Value interpolated(const LightChart& chart, const std::vector<Value>& values, const Eigen::Vector2f& place) {
  const float x = std::clamp(place.x() - 0.5F, 0.0F, static_cast<float>(chart.width - 1)),
              y = std::clamp(place.y() - 0.5F, 0.0F, static_cast<float>(chart.height - 1));
  const int left = static_cast<int>(x), top = static_cast<int>(y);
  const float right = x - static_cast<float>(left), down = y - static_cast<float>(top);
  const auto at = [&](int column, int row) -> const Value& {
    return values[static_cast<std::size_t>(std::min(row, chart.height - 1)) * static_cast<std::size_t>(chart.width) +
                  static_cast<std::size_t>(std::min(column, chart.width - 1))];
  };
  return (1 - down) * ((1 - right) * at(left, top) + right * at(left + 1, top)) +
         down * ((1 - right) * at(left, top + 1) + right * at(left + 1, top + 1));
}
GlossPlace interpolated(const LightChart& chart, const GlossMap& map, const Eigen::Vector2f& place);

/// Mean linear colour of each site, over the 3×3 texels around it and four view directions per visible side. `facing`:
/// facing_of().
std::vector<Radiance> site_colors(const BakedObject& object,
                                  const std::vector<std::shared_ptr<const LightChart>>& charts, const LightSites& sites,
                                  const std::vector<float>& facing);

/// Share of the first side in the visible surface of each site (1, ½ or 0), constant per connected component: from the
/// visibility of both sides and, if both are visible, from the side whose light explains the colours.
std::vector<float> facing_of(const LightSites& sites, const std::vector<SiteLight>& baked,
                             const std::vector<Radiance>& colors);

/// The visible sides, as the `wanted` of traced_light().
std::uint8_t visible_sides(float facing);
/// Irradiance / π of the visible surface.
Radiance visible_irradiance(const SiteLight& lit, float facing);

/// Specular fit of sites, and their visibility as baked and as edited.
struct GlossVisibility {
  std::shared_ptr<const GlossFit> fit;
  std::vector<SiteVisibility> before, after;
};

/// Maps for c' = max(0, c + ρ (E₁ − E₀)) with ρ = (c E₀ + λ ρ_part) / (E₀² + λ): linear in c, and exactly the identity
/// if E₁ = E₀. λ is (0.3 · the object's typical irradiance)². If light increases at a site that had less than √λ, c' is
/// bounded by the largest albedo of well-lit sites of its component (else of the object), so that surfaces that no
/// photograph saw do not glow. `before` and `after` are irradiances divided by π, `now` the sites as edited, `mirrors`
/// their reflection (null for matte sites). Returns a map per texture set; null entries change nothing.
std::vector<std::shared_ptr<const LightMap>> light_maps(const std::vector<std::shared_ptr<const LightChart>>& charts,
                                                        const LightSites& sites, const std::vector<Radiance>& colors,
                                                        const std::vector<Radiance>& before,
                                                        const std::vector<Radiance>& after,
                                                        const std::vector<LightSite>& now,
                                                        const GlossVisibility* mirrors = nullptr);

}  // namespace rebake
