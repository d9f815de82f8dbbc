#pragma once

#include "mesh_ops/light/geometry_image.h"
#include "mesh_ops/light/learnt_transfer.h"
#include "mesh_ops/light/unet_trainer.h"

namespace rebake {

/// Deep precomputed radiance transfer: a U-Net takes a geometry image of the pose, positions and normals, and gives
/// what turning leaves over of each texel's transfer. Unlike the published method, which predicts coefficients in the
/// body's space: a turned frame need not be learnt.
class UnetTransfer {
 public:
  /// Learns from poses as they are added; throws Error where there is no LibTorch.
  class Training {
   public:
    Training(ProxyMesh rest, GeometryImage image);
    void add(const std::vector<LightSite>& sites, const std::vector<Mat3>& turns,
             const std::vector<sh::Coefficients>& transfer);
    UnetTransfer learnt(const UnetTraining& options, const Progress& progress = {}) const;

   private:
    ProxyMesh rest_;
    GeometryImage image_;
    std::vector<float> images_;  ///< [pose][plane][texel]
    std::vector<float> local_;   ///< [pose][vertex][coefficient], in turned frames
    std::size_t poses_ = 0;
  };

  /// All of it, as files hold it.
  struct State {
    DiskChart chart;
    int side = 64, channels = 8;
    std::vector<float> weights;
    Box box;               ///< of the body at rest
    Eigen::VectorXf mean;  ///< [vertex][coefficient]: where the image is coarse, the surface keeps that
    float scale = 1;       ///< of departures from it
    double seconds = 0;    ///< of learning, without tracing
  };
  /// Throws std::invalid_argument where numbers do not go together.
  explicit UnetTransfer(State state);
  const State& state() const { return state_; }

  /// Coefficients of each vertex in turned frames, 16 after each other.
  Eigen::VectorXf predict(const std::vector<LightSite>& sites) const;
  std::uint64_t memory() const;
  double seconds() const { return state_.seconds; }

 private:
  State state_;  ///< its weights are the net's
  GeometryImage image_;
  Unet net_;
};

}  // namespace rebake
