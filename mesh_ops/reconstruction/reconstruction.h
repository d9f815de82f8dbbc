#pragma once

#include <memory>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/reconstruction/exposures.h"
#include "mesh_ops/reconstruction/pixel_mean.h"
#include "mesh_ops/reconstruction/ray_batch.h"
#include "mesh_ops/reconstruction/trained_network.h"
#include "mesh_ops/reconstruction/training_plan.h"

namespace rebake {

/// Axes of the directions that trained decoders take, for all kinds of captures: folders open without a word about
/// them.
inline constexpr Axes trained_axes = Axes::y_up;

/// The two fields of a reconstruction.
struct SceneFields {
  std::unique_ptr<SceneField> opacity;   ///< 1 output; starts near 3e-4
  std::unique_ptr<SceneField> features;  ///< 8 outputs
};
/// The fields of a plan: hash grids, or the published networks. Throws Error if those need a module that is missing.
SceneFields fields_of(const TrainingPlan& plan);

/// A scene in training (MobileNeRF, stages 1 and 2): a grid of free vertices, fields of opacity and features on its
/// triangles, a decoder, and an acceleration grid that tells empty cells. Deterministic at any number of threads.
class Reconstruction {
 public:
  /// `background`: display colour behind everything.
  Reconstruction(const TrainingPlan& plan, TrainingViews views, const Vec3& background, SceneFields fields);

  const TrainingPlan& plan() const { return plan_; }
  std::size_t steps_done() const { return steps_done_; }
  TrainingStage stage() const;
  /// One optimiser step. Returns the mean squared error of its pixels: of soft opacity in stage 1, of binary in
  /// stage 2.
  double step();

  /// Mean squared error of a photograph's valid pixels over all channels, drawn with binary opacity and the rays of
  /// stage 2. `every`: only each n-th row and column. `image`: the picture, as [pixel][channel], for `every` 1; null:
  /// not needed. Throws Cancelled.
  double error_of(const TrainingViews& views, std::size_t photograph, std::vector<float>* image, int every = 1,
                  const Progress& progress = {}) const;

  const TrainingViews& views() const { return views_; }
  TrainingViews& views() { return views_; }
  const FreeGrid& grid() const { return grid_; }
  /// Per cell: 1 if it may hold surface.
  const std::vector<std::uint8_t>& active() const { return active_; }
  const SceneFields& fields() const { return fields_; }
  /// Relative standard deviation of the photographs' exposures, known from the middle of stage 1 on; 0 before.
  double exposure_spread() const { return exposure_spread_; }
  /// Gives each photograph a gain from the start; estimates replace it from the middle of stage 1 on.
  void start_with_gains(const std::vector<Vec3>& gains);
  /// Whether each photograph has a gain per channel, because exposures differ.
  bool has_gains() const { return has_gains_; }
  const std::vector<Vec3>& gains() const { return gains_; }
  const FeatureNetwork& decoder() const { return decoder_.network(); }

  /// The state between two steps. The plan and the photographs are not part of it.
  std::string save() const;
  /// Throws Error for the state of another plan.
  void load(std::string_view bytes);

 private:
  struct SoftHits;
  double soft_step();
  double pixel_step(bool features_only);
  void shade(const RayBatch& batch, const std::vector<RayWeights>& weights, SoftHits& shown) const;
  void add_distortion(const RayBatch& batch, std::size_t ray, const WeightedHits& kind,
                      std::vector<float>& alpha_slopes) const;
  void update_geometry(const RayBatch& batch, const std::vector<float>& opacity_slopes,
                       const std::vector<FieldPoint>& feature_points, const std::vector<std::uint32_t>& shown,
                       const std::vector<double>& shares, double slots, double rate);
  void set_active();
  Vec3 step_background(SplitMix64& dice) const;
  void update_exposures();
  Vec3 off_by(const Vec3& shown, const Vec3& wanted, const TrainingViews::Pixel& pixel) const;
  void set_gains(const std::vector<Vec3>& gains);
  double rate() const;

  TrainingPlan plan_;
  TrainingViews views_;
  Vec3 background_;
  double mean_brightness_ = 0;
  SceneFields fields_;
  FreeGrid grid_;
  TrainedNetwork decoder_;
  std::vector<float> cells_;  // the acceleration grid
  std::vector<std::uint8_t> inner_, active_;
  std::vector<float> cell_gradient_, offset_gradient_;
  std::vector<Vec3> position_slopes_;
  GradientSteps cell_steps_, offset_steps_;
  std::size_t steps_done_ = 0;
  Exposures exposures_;
  double exposure_spread_ = 0;
  bool has_gains_ = false;
  std::vector<Vec3> gains_;
};

}  // namespace rebake
