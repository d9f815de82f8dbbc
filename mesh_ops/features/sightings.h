#pragma once

#include <vector>

#include "mesh_ops/features/composition.h"
#include "mesh_ops/network/feature_network.h"

namespace rebake {

/// From where a composition's texels can be seen: rays against the scene, as long as nothing opaque is in the way.
class Sightlines {
 public:
  explicit Sightlines(const Scene& scene);

  /// `count` directions, from the eye to the texels, spread over those in which the block is seen: the more often, the
  /// farther the eye can be and the less slanted the surface looks. Both sides count. All around where it is seen from
  /// nowhere. Other directions for another `phase`.
  std::vector<Vec3> directions(const std::vector<TexelSite>& sites, std::size_t count, std::uint64_t phase) const;

 private:
  SceneRays rays_;
  double size_;  ///< of the scene
};

/// Up to 16 texels of a block: four runs of four neighbours, far from each other, so that lanes l … l + 3 are mostly
/// near and l, l + 4, l + 8, l + 12 far apart. The last texel fills the lanes that are left.
struct TexelGroup {
  Lanes features[texel_features];  ///< decoded, of the texels as they were
  Lanes turn[9];                   ///< row-major, where turned
  Lanes gain[3], offset[3];        ///< what light makes of linear colours, where lit
  std::size_t count = 0;
  std::array<std::uint32_t, network_lanes> site{};  ///< of each lane, among the block's
  bool turned = false, lit = false;
  /// Of what mirrors: the part it belongs to, whose light says how, and each lane's place. The composition's.
  const Composition::Part* mirrors = nullptr;
  std::vector<GlossPlace> gloss{};
};
std::vector<TexelGroup> groups_of(const Composition& composition, const Composition::Block& block,
                                  const std::vector<TexelSite>& sites);

/// Means of four lanes as Sighting::mix says; 0: as they are.
Lanes mixed(const Lanes& own, std::uint32_t mix);

/// Display colours (3) of a group along a direction, by the rendering rule: features and directions of four texels
/// averaged for `mix` (see Sighting), scaled by `coverage`, decoded once, then changed by light, averaged for `mix`,
/// too. `work` is the kernels' workspace.
void teach(const FeatureNetwork& teacher, const TexelGroup& group, const Vec3& direction, float coverage,
           std::uint32_t mix, Lanes* colors, Lanes* work);

/// How a sighting looks at texels: three of eight alone, three as four neighbours, one as four that are far apart (as
/// small pictures do), and one at edges, where 1 to 3 of 4 samples are covered.
struct SightingKind {
  float coverage;
  std::uint32_t mix;
};
SightingKind sighting_kind(std::uint64_t number);

/// A sighting for each direction, of kinds `first`, `first + 1`, …
std::vector<Sighting> sightings_of(const FeatureNetwork& teacher, const TexelGroup& group,
                                   const std::vector<Vec3>& directions, std::uint64_t first, Lanes* work);

/// What tells texels apart, whatever decoder they come from: their colours along twelve directions, −1 … 1.
inline constexpr std::size_t signature_size = 36;
void signature(const FeatureNetwork& teacher, const TexelGroup& group, Lanes* result, Lanes* work);

}  // namespace rebake
