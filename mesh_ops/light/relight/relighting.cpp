#include "mesh_ops/light/relight/relighting.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "mesh_ops/index/footprint.h"
#include "mesh_ops/training/texel_colors.h"

namespace rebake {

namespace {

// Share of the typical irradiance; sites with less use the albedo of their part.
constexpr double dark_share = 0.3;

// Limit of gains and offsets. Beyond it everything is white; half floats can store it.
constexpr double largest = 1e4;

// Deviation of a part's colours from a single albedo under its light: the median absolute deviation of log(colour /
// light).
double unevenness(const std::vector<std::uint32_t>& part, const std::vector<SiteLight>& baked,
                  const std::vector<Radiance>& colors, double facing) {
  std::vector<double> logs;
  for (const std::uint32_t i : part) {
    const double light = (facing * baked[i].irradiance[0] + (1 - facing) * baked[i].irradiance[1]).sum();
    if (light > 0 && colors[i].sum() > 0) logs.push_back(std::log(colors[i].sum() / light));
  }
  if (logs.size() < 8) return 0;
  const auto middle = [](std::vector<double>& values) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), at, values.end());
    return *at;
  };
  const double center = middle(logs);
  for (double& value : logs) value = std::abs(value - center);
  return middle(logs);
}

}  // namespace

GlossPlace interpolated(const LightChart& chart, const GlossMap& map, const Eigen::Vector2f& place) {
  return {interpolated(chart, map.before.normals, place), interpolated(chart, map.after.normals, place),
          interpolated(chart, map.before.suns, place), interpolated(chart, map.after.suns, place)};
}

std::vector<float> facing_of(const LightSites& sites, const std::vector<SiteLight>& baked,
                             const std::vector<Radiance>& colors) {
  const std::size_t count = sites.part.empty() ? 0 : *std::max_element(sites.part.begin(), sites.part.end()) + 1;
  std::vector<std::vector<std::uint32_t>> parts(count);
  for (std::uint32_t i = 0; i < sites.size(); ++i) parts[sites.part[i]].push_back(i);
  std::vector<float> facing(sites.size());
  for (const std::vector<std::uint32_t>& part : parts) {
    if (part.empty()) continue;
    // Visibility that three of five sites exceed, so that rims and cracks do not count.
    std::array<float, 2> common{};
    for (std::size_t side = 0; side < 2; ++side) {
      std::vector<float> values;
      for (const std::uint32_t i : part) values.push_back(baked[i].open[side]);
      const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() * 2 / 5);
      std::nth_element(values.begin(), at, values.end());
      common[side] = *at;
    }
    auto best =
        static_cast<float>(facing_by_visibility(static_cast<double>(common[0]), static_cast<double>(common[1])));
    if (best == 0.5F) {
      // Both sides may be visible: decided by colours if their difference is clear.
      constexpr double clearly = 0.8, byte_step = 0.01;
      double least = unevenness(part, baked, colors, 0.5);
      least = least > byte_step ? clearly * least : 0;
      for (const float other : {1.0F, 0.0F})
        if (const double uneven = unevenness(part, baked, colors, static_cast<double>(other)); uneven < least) {
          least = uneven;
          best = other;
        }
    }
    for (const std::uint32_t i : part) facing[i] = best;
  }
  return facing;
}

std::uint8_t visible_sides(float facing) {
  return static_cast<std::uint8_t>((facing > 0 ? 1 : 0) + (facing < 1 ? 2 : 0));
}

Radiance visible_irradiance(const SiteLight& lit, float facing) {
  const double f = static_cast<double>(facing);
  return f * lit.irradiance[0] + (1 - f) * lit.irradiance[1];
}

std::vector<Radiance> site_colors(const BakedObject& object,
                                  const std::vector<std::shared_ptr<const LightChart>>& charts, const LightSites& sites,
                                  const std::vector<float>& facing) {
  std::vector<Radiance> colors(sites.size(), Radiance::Zero());
  const Mat3 axes = axes_matrix(object.axes);
  const TexelColors look(*object.decoder, {});
  for (std::size_t s = 0; s < charts.size(); ++s) {
    const TextureSet& set = object.sets[s];
    const TexelReader texels(*set.texels);
    const std::size_t first = sites.first[s];
    tbb::parallel_for(first, sites.first[s + 1], [&](std::size_t i) {
      const LightChart::Node& node = charts[s]->nodes[i - first];
      const auto corners = texel_corners(set, node.face);
      const Vec2 at = node.weights[0] * corners[0] + node.weights[1] * corners[1] + node.weights[2] * corners[2];
      const LightSite& site = sites.baked[i];
      const Vec3 across = site.normal.cross(site.tangent);
      // Four view directions per side.
      std::array<Vec3, 8> fed;
      for (std::size_t k = 0; k < fed.size(); ++k) {
        const double tilt = 0.7;
        const Vec3 aside = (k % 2 == 0 ? site.tangent : across) * (k % 4 < 2 ? 1 : -1);
        const Vec3 direction_to_eye =
            (std::cos(tilt) * (k < 4 ? 1 : -1) * site.normal + std::sin(tilt) * aside).normalized();
        fed[k] = axes * -direction_to_eye;
      }
      const double f = static_cast<double>(facing[i]);
      constexpr std::size_t most = 9 * 8;
      std::array<TexelColors::Features, most> features;
      std::array<Vec3, most> directions;
      std::array<double, most> shares;
      std::array<Color, most> seen;
      std::size_t count = 0;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          const int x = std::clamp(static_cast<int>(std::floor(at.x())) + dx, 0, set.texels->width() - 1),
                    y = std::clamp(static_cast<int>(std::floor(at.y())) + dy, 0, set.texels->height() - 1);
          if (!set.texels->opaque(x, y)) continue;
          const auto of_texel = decode_features(texels.at(x, y), set.texels->alpha_code());
          for (std::size_t k = 0; k < fed.size(); ++k) {
            const double share = k < 4 ? f : 1 - f;
            if (share == 0) continue;
            features[count] = of_texel;
            directions[count] = fed[k];
            shares[count++] = share;
          }
        }
      look.decode_each({features.data(), count}, {directions.data(), count}, {seen.data(), count});
      Radiance sum = Radiance::Zero();
      double weights = 0;
      for (std::size_t k = 0; k < count; ++k) {
        sum += shares[k] * Radiance(to_linear(seen[k].x()), to_linear(seen[k].y()), to_linear(seen[k].z()));
        weights += shares[k];
      }
      if (weights > 0) colors[i] = sum / weights;
    });
  }
  return colors;
}

namespace {

// Largest albedo of well-lit sites, per part and channel: the 99th percentile of colour / irradiance. Parts with few
// such sites use the object's; infinite if the object has few.
std::vector<Radiance> largest_albedos(const LightSites& sites, const std::vector<Radiance>& colors,
                                      const std::vector<Radiance>& before, const Radiance& lambda, std::size_t parts) {
  constexpr std::size_t min_sites = 16;
  constexpr double infinite = std::numeric_limits<double>::infinity();
  std::vector<Radiance> result(parts, Radiance::Constant(infinite));
  for (int c = 0; c < 3; ++c) {
    std::vector<double> all;
    std::vector<std::vector<double>> of_part(parts);
    for (std::size_t i = 0; i < sites.size(); ++i) {
      const double e = before[i][c];
      if (!(e > 0 && e * e >= lambda[c])) continue;
      all.push_back(colors[i][c] / e);
      of_part[sites.part[i]].push_back(all.back());
    }
    const auto high = [](std::vector<double>& values) {
      if (values.size() < min_sites) return infinite;
      const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() * 99 / 100);
      std::nth_element(values.begin(), at, values.end());
      return *at;
    };
    const double of_object = high(all);
    for (std::size_t p = 0; p < parts; ++p) result[p][c] = of_part[p].size() < min_sites ? of_object : high(of_part[p]);
  }
  return result;
}

// Upper bound of a site's new colour: `albedo` times the new light, plus the part of the old colour beyond `albedo`
// times the old light. That part fades as light grows, because the colours of surfaces that were never lit were never
// fitted. At unchanged light the bound is at least the colour itself.
double brightest(double color, double e, double after, double albedo, double root_lambda) {
  const double beyond = std::max(0.0, color - albedo * e), dark = 0.1 * root_lambda;
  return albedo * after + beyond * std::min(1.0, (e + dark) / (after + dark));
}

}  // namespace

std::vector<std::shared_ptr<const LightMap>> light_maps(const std::vector<std::shared_ptr<const LightChart>>& charts,
                                                        const LightSites& sites, const std::vector<Radiance>& colors,
                                                        const std::vector<Radiance>& before,
                                                        const std::vector<Radiance>& after,
                                                        const std::vector<LightSite>& now,
                                                        const GlossVisibility* mirrors) {
  // λ from the typical irradiance, its 90th percentile over the sites.
  Radiance lambda = Radiance::Zero();
  for (int c = 0; c < 3 && !before.empty(); ++c) {
    std::vector<double> values;
    for (const Radiance& e : before) values.push_back(e[c]);
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() * 9 / 10);
    std::nth_element(values.begin(), at, values.end());
    lambda[c] = dark_share * *at * dark_share * *at;
  }
  const std::size_t parts = sites.part.empty() ? 0 : *std::max_element(sites.part.begin(), sites.part.end()) + 1;
  std::vector<Radiance> ce(parts, Radiance::Zero()), ee(parts, Radiance::Zero());
  for (std::size_t i = 0; i < sites.size(); ++i) {
    ce[sites.part[i]] += colors[i].cwiseProduct(before[i]);
    ee[sites.part[i]] += before[i].cwiseProduct(before[i]);
  }
  const std::vector<Radiance> most = largest_albedos(sites, colors, before, lambda, parts);
  std::vector<std::shared_ptr<const LightMap>> maps;
  for (std::size_t s = 0; s < charts.size(); ++s) {
    LightMap map;
    map.chart = charts[s];
    const std::size_t texels = charts[s]->texel_count();
    map.gain.assign(texels, Eigen::Vector3f::Ones());
    map.offset.assign(texels, Eigen::Vector3f::Zero());
    bool any = false, any_offset = false;
    for (std::size_t i = sites.first[s]; i < sites.first[s + 1]; ++i) {
      const std::uint32_t texel = charts[s]->nodes[i - sites.first[s]].texel;
      for (int c = 0; c < 3; ++c) {
        const double e = before[i][c], change = after[i][c] - e, part = ee[sites.part[i]][c];
        // A site without a normal received no light that could change.
        if (change == 0 || !(e * e + lambda[c] > 0) || sites.baked[i].normal.isZero(0)) continue;
        any = true;
        const double albedo = part > 0 ? ce[sites.part[i]][c] / part : 0;
        double gain = std::min(largest, 1 + e * change / (e * e + lambda[c]));
        double offset = std::clamp(lambda[c] * albedo * change / (e * e + lambda[c]), -largest, largest);
        if (change > 0 && e * e < lambda[c] && std::isfinite(most[sites.part[i]][c])) {
          const double wanted = gain * colors[i][c] + offset;
          const double bound = brightest(colors[i][c], e, after[i][c], most[sites.part[i]][c], std::sqrt(lambda[c]));
          if (wanted > bound) {
            gain *= bound / wanted;
            offset *= bound / wanted;
          }
        }
        map.gain[texel][c] = static_cast<float>(gain);
        map.offset[texel][c] = static_cast<float>(offset);
        any_offset = any_offset || map.offset[texel][c] != 0;
      }
    }
    if (!any_offset) map.offset.clear();
    if (mirrors != nullptr)
      map.gloss = gloss_map(*charts[s], sites, now, sites.first[s], mirrors->fit, mirrors->before, mirrors->after);
    maps.push_back(any || map.gloss ? std::make_shared<const LightMap>(std::move(map)) : nullptr);
  }
  return maps;
}

}  // namespace rebake
