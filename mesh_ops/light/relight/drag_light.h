#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "mesh_ops/light/relight/cached_light.h"
#include "mesh_ops/light/relight/relighting.h"
#include "mesh_ops/light/transport/rotated_product.h"

namespace rebake {

struct TransferModel;

/// Preview of an object's light during a drag, without tracing. Each site's transfer rotates with the surface around
/// it, and a few rays test visibility of the suns. Only the change is added to the last traced light, so nothing jumps
/// when a drag begins. New mutual occlusion is not included; tracing adds it after the drag.
class DragLight {
 public:
  /// The light of one body.
  struct BodyLight {
    std::shared_ptr<const Light> light;
    Mat3 to_light;  ///< rotates object directions into the light's space
  };
  /// The state at the start of the drag, as traced.
  struct Start {
    std::shared_ptr<const BakedObject> object;  ///< the object as traced
    std::vector<std::shared_ptr<const LightChart>> charts;
    LightSites sites;
    std::vector<float> facing;  ///< per site: facing_of()
    /// Per site: linear colour as baked, irradiance / π as baked, irradiance / π as last traced.
    std::vector<Radiance> colors, before, after;
    std::vector<sh::Coefficients> transfer;      ///< per site: transfer of the visible surface, in object space
    std::vector<BodyLight> lights;               ///< light of each body
    std::shared_ptr<const TransferModel> model;  ///< trained model of the body; may be null
    std::vector<Occluder> others;                ///< other occluders, in object space
    std::optional<GlossVisibility> mirrors;      ///< reflection as traced
  };
  explicit DragLight(Start start);

  /// Whether an object has the same triangles as the start, at any positions: only such objects fit.
  bool fits(const BakedObject& object) const { return same_triangles(*start_.object, object); }
  /// Whether two objects have the same texels and, corner by corner, the same UVs.
  static bool same_triangles(const BakedObject& first, const BakedObject& second);
  /// Correction of the colours of a fitting object: one map per texture set; null entries change nothing.
  std::vector<std::shared_ptr<const LightMap>> maps(const BakedObject& object) const;
  /// Rotation of the surface around each site since the start, [texture set][node].
  std::vector<std::vector<Mat3>> rotations_on(const BakedObject& object) const;
  /// Irradiance / π per site of a fitting object.
  std::vector<Radiance> light_on(const BakedObject& object) const;
  /// The sites of a fitting object, given rotations_on() of it.
  std::vector<LightSite> sites_on(const BakedObject& object, const std::vector<std::vector<Mat3>>& turns) const;
  /// PoseSpace::Place::range of the pose; nothing without a model, or if the drag started outside its range.
  std::optional<double> range_of(const BakedObject& object) const;
  const Start& start() const { return start_; }

 private:
  Vec3 place_of(const BakedObject& object, std::size_t set, std::size_t node) const;
  std::vector<Radiance> light_on(const BakedObject& object, const std::vector<std::vector<Mat3>>& turns,
                                 const std::vector<LightSite>& sites) const;
  std::vector<Radiance> suns_on(const BakedObject& object, const std::vector<LightSite>& sites) const;
  void prepare_model();
  std::vector<Vec3> probes_on(const BakedObject& object) const;
  void add_learned(const BakedObject& object, const std::vector<std::vector<Mat3>>& turns,
                   const std::vector<LightSite>& sites, std::vector<Radiance>& light) const;

  Start start_;
  /// Interpolation of a site from four keys of the model; weights sum to 1, or are all 0.
  struct Share {
    std::array<std::uint32_t, 4> keys;
    std::array<float, 4> weights;
  };
  std::vector<Share> shares_;                 ///< per site; empty without a model
  std::vector<Mat3> since_baked_;             ///< per site: rotation since baking
  Eigen::VectorXf learned_;                   ///< prediction of the model at the start
  std::vector<RotatedProduct> products_;      ///< per body
  std::vector<Radiance> unrotated_, sunlit_;  ///< per site, at the start: irradiance / π by the sky and by the suns
};

/// Rotation of the surface around each node of a chart between two positions of a set's vertices: from the vertices'
/// stored rotations if present, else from the node's triangle.
std::vector<Mat3> node_rotations(const TextureSet& from, const TextureSet& to, const LightChart& chart);

}  // namespace rebake
