#pragma once

#include <vector>

#include "mesh_ops/features/distill/composition.h"
#include "mesh_ops/training/feature_network.h"

namespace rebake {

/// Samples the directions from which a composition's texels are visible, by rays against the opaque texels of the
/// scene.
class VisibleDirections {
 public:
  explicit VisibleDirections(const Scene& scene);

  /// `count` unit directions, from eye to texels, distributed over the visible directions of the block, with higher
  /// density for longer unoccluded distances and less slanted views. Both sides count. If the block is visible from
  /// nowhere, directions are spread evenly. Each `phase` gives different directions.
  std::vector<Vec3> directions(const std::vector<TexelSite>& sites, std::size_t count, std::uint64_t phase) const;

 private:
  SceneRays rays_;
  double size_;  ///< diagonal of the scene's bounding box
};

/// Up to 16 texels of a block as SIMD lanes: four runs of four neighbours, and the runs are far from each other. So
/// lanes l … l + 3 are mostly adjacent, and l, l + 4, l + 8, l + 12 far apart. The last texel fills unused lanes.
struct TexelGroup {
  Lanes features[texel_features];                   ///< features of the original texels
  Lanes turn[9];                                    ///< rotation (TexelSite::turn), row-major; used if `turned`
  Lanes gain[3], offset[3];                         ///< light correction of linear colours; used if `lit`
  std::size_t count = 0;                            ///< number of texels
  std::array<std::uint32_t, network_lanes> site{};  ///< per lane: index among the block's sites
  bool turned = false, lit = false;
  /// For groups with specular changes: the part whose light applies (owned by the composition; else null), and the
  /// reflection data per lane.
  const Composition::Part* mirrors = nullptr;
  std::vector<GlossPlace> gloss{};
};
/// The texels of a block in groups.
std::vector<TexelGroup> groups_of(const Composition& composition, const Composition::Block& block,
                                  const std::vector<TexelSite>& sites);

/// Means of four lanes l, l + mix, l + 2 mix and l + 3 mix (modulo 16), as in ViewSample::mix; 0: unchanged.
Lanes mixed(const Lanes& own, std::uint32_t mix);

/// Display colours (3 × lanes) of a group along a direction by the rendering rule: features and directions are averaged
/// over four texels as given by `mix` (see mixed()), scaled by `coverage` and decoded once. The result is corrected by
/// light, which is averaged likewise. `work` is the kernels' workspace.
void teacher_colors(const FeatureNetwork& teacher, const TexelGroup& group, const Vec3& direction, float coverage,
                    std::uint32_t mix, Lanes* colors, Lanes* work);

/// How texels are mixed in a simulated pixel. Of every eight observations, three are of single texels, three of four
/// neighbours, one of four distant texels (as in small pictures), and one at edges, where 1 to 3 of 4 samples are
/// covered.
struct ViewSampleKind {
  float coverage;     ///< covered share of the pixel
  std::uint32_t mix;  ///< see mixed()
};
ViewSampleKind view_sample_kind(std::uint64_t number);

/// One observation per direction, of kinds `first`, `first + 1`, …
std::vector<ViewSample> view_samples_of(const FeatureNetwork& teacher, const TexelGroup& group,
                                        const std::vector<Vec3>& directions, std::uint64_t first, Lanes* work);

/// Decoder-independent descriptor of texels: colours along twelve directions, scaled to −1 … 1; signature_size lanes.
inline constexpr std::size_t signature_size = 36;
void signature(const FeatureNetwork& teacher, const TexelGroup& group, Lanes* result, Lanes* work);

}  // namespace rebake
