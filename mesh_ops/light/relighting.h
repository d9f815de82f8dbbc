#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "mesh_ops/light/gloss.h"

namespace rebake {

/// What a change of light does to the colours of a texture set: linear colour → max(0, gain · colour + offset), a
/// channel, interpolated between the chart's nodes.
struct LightMap {
  std::shared_ptr<const LightChart> chart;
  std::vector<Eigen::Vector3f> gain;      ///< a texel of the chart
  std::vector<Eigen::Vector3f> offset;    ///< likewise; empty where all are 0
  std::shared_ptr<const GlossMap> gloss;  ///< what is added by direction; null where nothing that is mirrored changes
};

/// Values of a chart's texels at a place (LightChart::places), bilinearly between their centres, as the GPU does.
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

/// What sites mirror, and what is open over them as they were baked and as they are.
struct Mirrors {
  std::shared_ptr<const GlossFit> fit;
  std::vector<Openness> before, after;
};

/// c' = max(0, c + ρ (E₁ − E₀)) with ρ = (c E₀ + λ ρ_part) / (E₀² + λ): linear in c, exactly the identity where E₁ =
/// E₀. Where light grows at a site that had less than √λ, c' is bounded by the largest albedo of well-lit sites of its
/// part (else of the object): surfaces that no photograph saw do not glow. `before` and `after` are irradiances over π,
/// λ is (0.3 · the object's common irradiance)². A map a texture set; null where nothing changes. `now` are the sites
/// as they are, of which `mirrors` (null for matte ones) says more.
std::vector<std::shared_ptr<const LightMap>> light_maps(const std::vector<std::shared_ptr<const LightChart>>& charts,
                                                        const LightSites& sites, const std::vector<Radiance>& colors,
                                                        const std::vector<Radiance>& before,
                                                        const std::vector<Radiance>& after,
                                                        const std::vector<LightSite>& now,
                                                        const Mirrors* mirrors = nullptr);

}  // namespace rebake
