#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mesh_ops/light/baked_light.h"
#include "mesh_ops/light/change_estimate.h"

namespace rebake {

/// One object of a scene whose colours light may change: what its own edits and others may take from its light, and the
/// change itself. What that needs is made when it is first asked for.
class LightReceiver {
 public:
  /// All of these must outlive it.
  LightReceiver(const std::vector<PlacedNode>& objects, std::size_t own, const SceneLight& settings,
                const LightingOptions& options, BakedLights& known);

  const std::string& name() const { return placed().node->name; }
  /// Whether triangles moved against their object, or were joined with others'.
  bool moved() const { return moved_; }
  /// Whether some of what it was baked with is gone.
  bool missing() const { return missing_; }
  /// Whether another object is part of the same body, still in one piece with it.
  bool related(std::size_t other) const;

  /// Another light than its own; `to_light` turns the world's directions into the light's.
  struct Shared {
    const Light* light = nullptr;  ///< null: each object stands in its own
    Mat3 to_light = Mat3::Identity();
  };

  /// An upper bound of what another object takes from this one's light, in display colours. A sun counts where a ray to
  /// it may meet the other's bounding sphere.
  double cast_bound(std::size_t other, const Shared& shared, const Progress& progress);
  /// About what an effect changes, by 2048 sites, 64 rays each.
  ChangeEstimate sampled_change(bool self, bool removed, const Progress& progress);
  /// What it mirrors of a light that its triangles have turned in; null where it does not, and where it was joined of
  /// others or stands in another light than its own.
  std::shared_ptr<const GlossFit> gloss(const Shared& shared, const Progress& progress);
  /// Why that is null.
  std::string why_matte(const Shared& shared) const;
  /// About what turning changes of that, by 2048 sites, each seen from 24 sides.
  ChangeEstimate mirrored_change(const GlossFit& fit) const;
  /// Irradiance over π of its sites, as baked and under what runs, and their colours.
  struct Change {
    std::vector<Radiance> before, after, colors;
    std::optional<Mirrors> mirrors;
  };
  /// `gloss`: null where highlights stay as they were baked.
  Change change(bool self, bool removed, const std::vector<std::size_t>& casters, const Shared& shared,
                const std::shared_ptr<const GlossFit>& gloss, const Progress& progress);
  /// What that does to colours, a map a texture set; null where nothing changes.
  std::vector<std::shared_ptr<const LightMap>> maps(const Change& change) const;
  /// The same, to go along with triangles that move on; null where it cannot.
  std::shared_ptr<const TurnedLight> turned(const Change& change, const std::vector<std::size_t>& casters,
                                            const Shared& shared, const Progress& progress) const;

  /// What it was baked in: found or given. Throws EditError for a node that is flattened.
  std::shared_ptr<const Light> light(const Progress& progress);
  double confidence() const { return baked_->confidence; }
  /// Turns its light's directions into the world's.
  Mat3 turn() const;

 private:
  const PlacedNode& placed() const { return objects_[own_]; }
  const BakedObject& object() const { return *placed().node->object; }
  const Affine& to_world() const { return placed().to_world; }
  bool anything_missing() const;
  std::shared_ptr<const TransferModel> kept_model() const;
  bool in_world() const;
  Mat3 to_own_light() const;
  void prepare(const Progress& progress);
  /// Sites in the space that light is traced in.
  const std::vector<LightSite>& now() const;
  Radiance shown(std::size_t i, const std::vector<SiteLight>& lit) const;
  Occluder occluder(std::size_t k) const;
  std::vector<Occluder> relatives() const;
  std::vector<SiteLight> light_before(bool self, bool removed, const std::vector<std::uint8_t>& wanted, int rays,
                                      const Progress& progress) const;
  std::vector<SiteLight> light_after(const std::vector<std::size_t>& casters, const std::vector<std::uint8_t>& wanted,
                                     int rays, const Shared& shared, const Progress& progress) const;

  const std::vector<PlacedNode>& objects_;
  std::size_t own_;
  const SceneLight& settings_;
  const LightingOptions& options_;
  std::vector<std::size_t> relatives_;
  bool moved_ = false, missing_ = false;
  BakedLights& known_;
  // Made by prepare():
  std::shared_ptr<BakedLight> baked_;
  std::vector<std::shared_ptr<const LightChart>> charts_;  ///< of its own arrays
  std::vector<LightSite> in_world_;                        ///< the sites, where the node is sheared
};

}  // namespace rebake
