#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mesh_ops/light/estimate/change_estimate.h"
#include "mesh_ops/light/relight/baked_light.h"
#include "mesh_ops/light/relight/drag_light.h"

namespace rebake {

/// One object of a scene as receiver of light: bounds and estimates of the effects of its own edits and of other
/// objects, and the correction of its colours. Data is prepared on first use.
class LightReceiver {
 public:
  /// All references must outlive this object.
  LightReceiver(const std::vector<PlacedNode>& objects, std::size_t own, const SceneLight& settings,
                const LightingOptions& options, BakedLights& known);

  const std::string& name() const { return placed().node->name; }
  /// Whether triangles moved relative to their object, or were merged with those of others.
  bool moved() const { return moved_; }
  /// Whether parts that it was baked with have been removed.
  bool missing() const { return missing_; }
  /// Whether another object belongs to the same body and has not moved relative to this one.
  bool related(std::size_t other) const;

  /// A light shared by objects; `to_light` rotates world directions into the light's space.
  struct Shared {
    const Light* light = nullptr;  ///< null: each object uses its own light
    Mat3 to_light = Mat3::Identity();
  };

  /// Upper bound of the shadow of another object on this one, in display colours. A sun counts if a ray to it may meet
  /// the other's bounding sphere.
  double cast_bound(std::size_t other, const Shared& shared, const Progress& progress);
  /// Estimated change by the self-shadow and the removed shadow, from up to 2048 sites with 64 rays each.
  ChangeEstimate sampled_change(bool self, bool removed, const Progress& progress);
  /// Specular fit if triangles have rotated; null if nothing is reflected, if the object was merged from others, or if
  /// it uses a light other than its own.
  std::shared_ptr<const GlossFit> gloss(const Shared& shared, const Progress& progress);
  /// Wording of the reason why gloss() is null.
  std::string no_gloss_reason(const Shared& shared) const;
  /// Estimated change of the reflection by rotation, from up to 2048 sites with 24 view directions each.
  ChangeEstimate estimated_gloss_change(const GlossFit& fit) const;
  /// Irradiance (divided by π) of the sites as baked and with the running effects, and their colours.
  struct Change {
    std::vector<Radiance> before, after, colors;
    std::optional<GlossVisibility> mirrors;
  };
  /// `gloss`: null if highlights stay as baked.
  Change change(bool self, bool removed, const std::vector<std::size_t>& casters, const Shared& shared,
                const std::shared_ptr<const GlossFit>& gloss, const Progress& progress);
  /// The correction of colours: one map per texture set; null entries change nothing.
  std::vector<std::shared_ptr<const LightMap>> maps(const Change& change) const;
  /// The correction in a form that follows dragged triangles; null if not possible.
  std::shared_ptr<const DragLight> turned(const Change& change, const std::vector<std::size_t>& casters,
                                          const Shared& shared, const Progress& progress) const;

  /// The light it was baked in, estimated or given. Throws EditError for a node with a singular transform.
  std::shared_ptr<const Light> light(const Progress& progress);
  double confidence() const { return baked_->confidence; }
  /// Rotation from its light's space to the world.
  Mat3 turn() const;

 private:
  const PlacedNode& placed() const { return objects_[own_]; }
  const BakedObject& object() const { return *placed().node->object; }
  const Affine& to_world() const { return placed().to_world; }
  bool anything_missing() const;
  std::shared_ptr<const TransferModel> cached_model() const;
  bool in_world() const;
  Mat3 to_own_light() const;
  void prepare(const Progress& progress);
  /// Sites as edited, in the space of tracing (object space, or world space for sheared nodes).
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
  // Set by prepare():
  std::shared_ptr<BakedLight> baked_;
  std::vector<std::shared_ptr<const LightChart>> charts_;  ///< the object's charts, with its own UV arrays
  std::vector<LightSite> in_world_;                        ///< sites in world space, for sheared nodes
};

}  // namespace rebake
