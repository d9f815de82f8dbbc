#include "mesh_ops/features/distill/view_samples.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mesh_ops/base/elementary.h"
#include "mesh_ops/index/index.h"

namespace rebake {

namespace {

constexpr std::size_t probes = 128;

// Fibonacci lattice on the sphere (Swinbank & Purser 2006).
const std::array<Vec3, probes>& fibonacci_sphere() {
  static const std::array<Vec3, probes> points = [] {
    std::array<Vec3, probes> result;
    for (std::size_t k = 0; k < probes; ++k) {
      const double z = 1 - (2 * static_cast<double>(k) + 1) / probes, r = std::sqrt(1 - z * z);
      const auto turn = elementary::sine_cosine(static_cast<double>(k) * std::numbers::pi * (3 - std::sqrt(5.0)));
      result[k] = {r * turn.cosine, r * turn.sine, z};
    }
    return result;
  }();
  return points;
}

const std::array<Vec3, 12>& icosahedron() {
  static const std::array<Vec3, 12> points = [] {
    std::array<Vec3, 12> result;
    std::size_t k = 0;
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      for (const double a : {-1.0, 1.0})
        for (const double b : {-std::numbers::phi, std::numbers::phi}) {
          Vec3 p = Vec3::Zero();
          p[axis] = a;
          p[(axis + 1) % 3] = b;
          result[k++] = p.normalized();
        }
    return result;
  }();
  return points;
}

SceneRays rays_through_visible(const Scene& scene) {
  std::vector<PlacedNode> objects;
  for (PlacedNode& placed : placed_nodes(scene))
    if (placed.visible && placed.node->object && placed.node->object->triangle_count() > 0)
      objects.push_back(std::move(placed));
  return rays_through(objects);
}

}  // namespace

VisibleDirections::VisibleDirections(const Scene& scene)
    : rays_(rays_through_visible(scene)), size_(world_bounds(scene).diagonal().norm()) {}

std::vector<Vec3> VisibleDirections::directions(const std::vector<TexelSite>& sites, std::size_t count,
                                                std::uint64_t phase) const {
  if (sites.empty() || count == 0) return {};
  Box box;
  for (const TexelSite& site : sites) box.extend(site.position);
  // Hits nearer than half a texel do not occlude: they are neighbours on the surface itself.
  const double texel = box.diagonal().norm() / std::sqrt(static_cast<double>(sites.size()));
  const double near = 0.5 * texel + 1e-6 * size_;
  SplitMix64 dice(phase * 0x2545f4914f6cdd1dU + 1);
  const auto& sphere = fibonacci_sphere();
  std::array<double, probes> weight{};
  // Packets of eight coherent rays from one texel.
  for (int round = 0; round < 2; ++round)
    for (std::size_t first = 0; first < probes; first += 8) {
      const TexelSite& site = sites[dice.below(sites.size())];
      SceneRays::Bundle bundle;
      for (std::size_t k = 0; k < 8; ++k) {
        bundle.origins[k] = site.position;
        bundle.directions[k] = sphere[first + k];
        bundle.far[k] = size_;
      }
      rays_.nearest(bundle, near);
      for (std::size_t k = 0; k < 8; ++k) {
        const double free = bundle.hits[k] ? bundle.hits[k]->t / size_ : 1;
        weight[first + k] += free * free * std::max(0.05, std::abs(site.normal.dot(sphere[first + k])));
      }
    }
  double total = 0;
  for (const double w : weight) total += w;
  if (!(total > 0)) {
    weight.fill(1);
    total = probes;
  }
  std::vector<Vec3> result;
  std::size_t at = 0;
  double passed = weight[0];
  const double offset = dice.share();
  for (std::size_t k = 0; k < count; ++k) {
    const double wanted = total * (static_cast<double>(k) + offset) / static_cast<double>(count);
    while (passed < wanted && at + 1 < probes) passed += weight[++at];
    // Jittered within the probe's cell, which is about 0.3 wide.
    Vec3 outwards = sphere[at];
    for (Eigen::Index axis = 0; axis < 3; ++axis) outwards[axis] += 0.3 * (dice.share() - 0.5);
    result.push_back(-outwards.normalized());
  }
  return result;
}

std::vector<TexelGroup> groups_of(const Composition& composition, const Composition::Block& block,
                                  const std::vector<TexelSite>& sites) {
  const TexelReader texels(*composition.pages[block.page].texels);
  const AlphaCode code = composition.pages[block.page].texels->alpha_code();
  const std::size_t runs = (sites.size() + 3) / 4, count = (runs + 3) / 4;
  std::vector<TexelGroup> groups(count);
  for (std::size_t g = 0; g < count; ++g) {
    TexelGroup& group = groups[g];
    group.turned = composition.parts[block.part].bent;
    const Composition::Part& part = composition.parts[block.part];
    group.lit = part.light != nullptr;
    if (group.lit && part.light->gloss) group.mirrors = &part;
    for (std::size_t k = 0; k < 4; ++k)
      for (std::size_t t = 4 * (g + k * count); t < std::min(sites.size(), 4 * (g + k * count) + 4); ++t)
        group.site[group.count++] = static_cast<std::uint32_t>(t);
    std::fill(group.site.begin() + static_cast<std::ptrdiff_t>(group.count), group.site.end(),
              group.site[group.count - 1]);
    for (std::size_t l = 0; l < network_lanes; ++l) {
      const TexelSite& site = sites[group.site[l]];
      const auto features = decode_features(texels.at(site.x, site.y), code);
      for (std::size_t c = 0; c < texel_features; ++c) group.features[c].at[l] = static_cast<float>(features[c]);
      for (std::size_t k = 0; k < 9; ++k)
        group.turn[k].at[l] =
            static_cast<float>(site.turn(static_cast<Eigen::Index>(k / 3), static_cast<Eigen::Index>(k % 3)));
      for (std::size_t c = 0; c < 3; ++c) {
        group.gain[c].at[l] = site.gain[static_cast<Eigen::Index>(c)];
        group.offset[c].at[l] = site.offset[static_cast<Eigen::Index>(c)];
      }
      if (group.mirrors != nullptr) group.gloss.push_back(site.gloss);
    }
  }
  return groups;
}

Lanes mixed(const Lanes& own, std::uint32_t mix) {
  if (mix == 0) return own;
  Lanes mean;
  for (std::size_t l = 0; l < network_lanes; ++l) {
    const auto other = [&](std::size_t k) { return own.at[(l + k * mix) % network_lanes]; };
    mean.at[l] = 0.25F * ((other(0) + other(1)) + (other(2) + other(3)));
  }
  return mean;
}

void teacher_colors(const FeatureNetwork& teacher, const TexelGroup& group, const Vec3& direction, float coverage,
                    std::uint32_t mix, Lanes* colors, Lanes* work) {
  Lanes input[decoder_inputs];
  for (std::size_t c = 0; c < texel_features; ++c) input[c] = group.features[c];
  Lanes* fed = input + texel_features;
  Lanes added[3] = {group.offset[0], group.offset[1], group.offset[2]};
  for (std::size_t l = 0; l < network_lanes; ++l) {
    Vec3 d = direction;
    if (group.turned) {
      Mat3 turn;
      for (std::size_t k = 0; k < 9; ++k)
        turn(static_cast<Eigen::Index>(k / 3), static_cast<Eigen::Index>(k % 3)) =
            static_cast<double>(group.turn[k].at[l]);
      // Zero if the corners' rotations differ by half a turn and have no mean.
      d = (turn * direction).stableNormalized();
    }
    for (std::size_t axis = 0; axis < 3; ++axis)
      fed[axis].at[l] = static_cast<float>(d[static_cast<Eigen::Index>(axis)]);
    if (group.mirrors == nullptr) continue;
    const Radiance gain(static_cast<double>(group.gain[0].at[l]), static_cast<double>(group.gain[1].at[l]),
                        static_cast<double>(group.gain[2].at[l]));
    const Radiance mirrored = gloss_change(*group.mirrors->light->gloss->gloss, group.gloss[l], gain,
                                           group.mirrors->to_baked * d, group.mirrors->to_object * direction);
    for (std::size_t c = 0; c < 3; ++c) added[c].at[l] += static_cast<float>(mirrored[static_cast<Eigen::Index>(c)]);
  }
  for (Lanes& lane : input) {
    lane = mixed(lane, mix);
    for (float& value : lane.at) value *= coverage;
  }
  decode_lanes(teacher, input, colors, work);
  if (!group.lit) return;
  for (std::size_t c = 0; c < 3; ++c) {
    const Lanes gain = mixed(group.gain[c], mix), offset = mixed(added[c], mix);
    for (std::size_t l = 0; l < network_lanes; ++l) {
      if (gain.at[l] == 1 && offset.at[l] == 0) continue;
      const double linear = static_cast<double>(gain.at[l]) * to_linear(static_cast<double>(colors[c].at[l])) +
                            static_cast<double>(offset.at[l]);
      // A folder cannot store colours brighter than white.
      colors[c].at[l] = static_cast<float>(to_display(std::clamp(linear, 0.0, 1.0)));
    }
  }
}

ViewSampleKind view_sample_kind(std::uint64_t number) {
  switch (number % 8) {
    case 1:
    case 3:
    case 5:
      return {1, 1};
    case 6:
      return {1, 4};
    case 7:
      return {0.25F * static_cast<float>(1 + number / 8 % 3), 0};
    default:
      return {1, 0};
  }
}

std::vector<ViewSample> view_samples_of(const FeatureNetwork& teacher, const TexelGroup& group,
                                        const std::vector<Vec3>& directions, std::uint64_t first, Lanes* work) {
  std::vector<ViewSample> result(directions.size());
  for (std::size_t k = 0; k < directions.size(); ++k) {
    ViewSample& view_sample = result[k];
    const ViewSampleKind kind = view_sample_kind(first + k);
    for (std::size_t axis = 0; axis < 3; ++axis)
      std::fill_n(view_sample.direction[axis].at, network_lanes,
                  static_cast<float>(directions[k][static_cast<Eigen::Index>(axis)]));
    teacher_colors(teacher, group, directions[k], kind.coverage, kind.mix, view_sample.target, work);
    view_sample.coverage = kind.coverage;
    view_sample.mix = kind.mix;
    // A pixel of which half is covered shows half of the error.
    view_sample.weight = kind.coverage * kind.coverage;
  }
  return result;
}

void signature(const FeatureNetwork& teacher, const TexelGroup& group, Lanes* result, Lanes* work) {
  for (const Vec3& direction : icosahedron()) {
    teacher_colors(teacher, group, direction, 1, 0, result, work);
    for (std::size_t c = 0; c < 3; ++c)
      for (float& value : result[c].at) value = 2 * value - 1;
    result += 3;
  }
}

}  // namespace rebake
