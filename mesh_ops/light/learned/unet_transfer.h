#pragma once

#include "mesh_ops/light/learned/geometry_image.h"
#include "mesh_ops/light/learned/learned_transfer.h"
#include "mesh_ops/light/learned/unet_trainer.h"

namespace rebake {

/// Deep precomputed radiance transfer: a U-Net maps a geometry image of the pose (positions and normals) to each
/// texel's transfer in frames that rotate with the surface. The published method predicts coefficients in the body's
/// space; in rotated frames the network need not learn the rotation.
class UnetTransfer {
 public:
  /// Training set that is filled pose by pose. learned() trains a network on it and throws Error without LibTorch.
  class Training {
   public:
    Training(ProxyMesh rest, GeometryImage image);
    void add(const std::vector<LightSite>& sites, const std::vector<Mat3>& turns,
             const std::vector<sh::Coefficients>& transfer);
    UnetTransfer learned(const UnetTraining& options, const Progress& progress = {}) const;

   private:
    ProxyMesh rest_;
    GeometryImage image_;
    std::vector<float> images_;  ///< [pose][plane][texel]
    std::vector<float> local_;   ///< [pose][vertex][coefficient], in rotated frames
    std::size_t poses_ = 0;
  };

  /// The complete state, as stored in files.
  struct State {
    DiskChart chart;
    int side = 64, channels = 8;
    std::vector<float> weights;
    Box box;               ///< bounds of the body at rest
    Eigen::VectorXf mean;  ///< mean over the poses, [vertex][coefficient]
    float scale = 1;       ///< scale of deviations from the mean
    double seconds = 0;    ///< training time, without tracing
  };
  /// Throws std::invalid_argument for inconsistent sizes.
  explicit UnetTransfer(State state);
  const State& state() const { return state_; }

  /// 16 coefficients per vertex, in rotated frames.
  Eigen::VectorXf predict(const std::vector<LightSite>& sites) const;
  std::uint64_t memory() const;
  double seconds() const { return state_.seconds; }

 private:
  State state_;  ///< its weights equal those of net_
  GeometryImage image_;
  Unet net_;
};

}  // namespace rebake
