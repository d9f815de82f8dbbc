#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "mesh_ops/light/kept_light.h"
#include "mesh_ops/light/relighting.h"
#include "mesh_ops/light/turned_product.h"

namespace rebake {

struct TransferModel;

/// What light does to an object whose triangles move on from where light was traced last, fast enough to go along with
/// a drag: each site's transfer turns with the surface around it, which changes what it takes of the sky, and a few
/// rays say what it sees of a sun. Only changes are added to what was traced, so that nothing jumps when a drag begins.
/// Where parts newly hide the sky from each other is not in it: tracing says that.
class TurnedLight {
 public:
  struct BodyLight {
    std::shared_ptr<const Light> light;
    Mat3 to_light;  ///< turns the object's directions into the light's
  };
  struct Start {
    std::shared_ptr<const BakedObject> object;  ///< where it was traced
    std::vector<std::shared_ptr<const LightChart>> charts;
    LightSites sites;
    std::vector<float> facing;                    ///< as facing_of
    std::vector<Radiance> colors, before, after;  ///< of each site: as baked; irradiance over π it was baked in; traced
    std::vector<sh::Coefficients> transfer;       ///< of what it shows, in the object's space
    std::vector<BodyLight> lights;                ///< of each body
    std::shared_ptr<const TransferModel> model;   ///< of its body, to tell more than turning does; may be null
    std::vector<Occluder> others;                 ///< what else shades it, in its space
    std::optional<Mirrors> mirrors;               ///< as where it was traced
  };
  explicit TurnedLight(Start start);

  /// Whether an object has the same triangles, maybe elsewhere.
  bool fits(const BakedObject& object) const { return same_triangles(*start_.object, object); }
  static bool same_triangles(const BakedObject& first, const BakedObject& second);
  /// The change of colours of an object that fits, a map a texture set; null where nothing changes.
  std::vector<std::shared_ptr<const LightMap>> maps(const BakedObject& object) const;
  /// How the surface around each site turned to get there, set by set.
  std::vector<std::vector<Mat3>> turns_on(const BakedObject& object) const;
  /// Irradiance over π of each site there.
  std::vector<Radiance> light_on(const BakedObject& object) const;
  /// The sites when they have turned so.
  std::vector<LightSite> sites_on(const BakedObject& object, const std::vector<std::vector<Mat3>>& turns) const;
  /// How far out a pose is of those that the model was learnt from (PoseSpace::Place::range); nothing without one, and
  /// where it started outside of them.
  std::optional<double> range_of(const BakedObject& object) const;
  const Start& start() const { return start_; }

 private:
  Vec3 place_of(const BakedObject& object, std::size_t set, std::size_t node) const;
  std::vector<Radiance> light_on(const BakedObject& object, const std::vector<std::vector<Mat3>>& turns,
                                 const std::vector<LightSite>& sites) const;
  std::vector<Radiance> suns_on(const BakedObject& object, const std::vector<LightSite>& sites) const;
  void prepare_model();
  std::vector<Vec3> probes_on(const BakedObject& object) const;
  void add_learnt(const BakedObject& object, const std::vector<std::vector<Mat3>>& turns,
                  const std::vector<LightSite>& sites, std::vector<Radiance>& light) const;

  Start start_;
  /// Of each site the keys that it takes from, and how much of each.
  struct Share {
    std::array<std::uint32_t, 4> keys;
    std::array<float, 4> weights;
  };
  std::vector<Share> shares_;                ///< empty without a model
  std::vector<Mat3> since_baked_;            ///< of each site, how it had turned
  Eigen::VectorXf learnt_;                   ///< what the model says of the start
  std::vector<TurnedProduct> products_;      ///< of each body
  std::vector<Radiance> unturned_, sunlit_;  ///< of each site, where it was traced
};

/// How the surface around a node of a chart turned from one place of a set's vertices to another, a node. By the
/// vertices' own rotations where the set keeps them, else by its triangle.
std::vector<Mat3> node_turns(const TextureSet& from, const TextureSet& to, const LightChart& chart);

}  // namespace rebake
