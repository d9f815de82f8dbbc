#pragma once

#include <vector>

#include "mesh_ops/features/composition.h"
#include "mesh_ops/network/feature_network.h"

namespace rebake {

/// Directions from which a composition's texels are visible, by rays against the opaque texels of the scene.
class Sightlines {
 public:
  explicit Sightlines(const Scene& scene);

  /// `count` directions, from eye to texels, distributed over the visible directions of the block, with higher density
  /// for longer unoccluded distances and less slanted views. Both sides count. All around if the block is visible from
  /// nowhere. Each `phase` gives different directions.
  std::vector<Vec3> directions(const std::vector<TexelSite>& sites, std::size_t count, std::uint64_t phase) const;

 private:
  SceneRays rays_;
  double size_;  ///< size of the scene
};

/// Up to 16 texels of a block as lanes: four runs of four neighbours that are far from each other, so lanes l … l + 3
/// are mostly adjacent, and l, l + 4, l + 8, l + 12 far apart. The last texel fills unused lanes.
struct TexelGroup {
  Lanes features[texel_features];  ///< features of the original texels
  Lanes turn[9];                   ///< rotation, row-major, if `turned`
  Lanes gain[3], offset[3];        ///< light correction of linear colours, if `lit`
  std::size_t count = 0;
  std::array<std::uint32_t, network_lanes> site{};  ///< per lane: index among the block's sites
  bool turned = false, lit = false;
  /// For specular groups: the part whose light applies (owned by the composition), and the place per lane.
  const Composition::Part* mirrors = nullptr;
  std::vector<GlossPlace> gloss{};
};
std::vector<TexelGroup> groups_of(const Composition& composition, const Composition::Block& block,
                                  const std::vector<TexelSite>& sites);

/// Means of four lanes as given by Sighting::mix; 0: unchanged.
Lanes mixed(const Lanes& own, std::uint32_t mix);

/// Display colours (3 × lanes) of a group along a direction by the rendering rule: features and directions are averaged
/// over four texels as given by `mix` (see Sighting), scaled by `coverage`, decoded once, then corrected by light,
/// averaged likewise. `work` is the kernels' workspace.
void teach(const FeatureNetwork& teacher, const TexelGroup& group, const Vec3& direction, float coverage,
           std::uint32_t mix, Lanes* colors, Lanes* work);

/// Kinds of observations: of every eight, three of single texels, three of four neighbours, one of four distant texels
/// (as in small pictures), and one at edges, where 1 to 3 of 4 samples are covered.
struct SightingKind {
  float coverage;
  std::uint32_t mix;
};
SightingKind sighting_kind(std::uint64_t number);

/// An observation per direction, of kinds `first`, `first + 1`, …
std::vector<Sighting> sightings_of(const FeatureNetwork& teacher, const TexelGroup& group,
                                   const std::vector<Vec3>& directions, std::uint64_t first, Lanes* work);

/// Decoder-independent descriptor of a texel: its colours along twelve directions, −1 … 1.
inline constexpr std::size_t signature_size = 36;
void signature(const FeatureNetwork& teacher, const TexelGroup& group, Lanes* result, Lanes* work);

}  // namespace rebake
