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

  /// Coefficients of each vertex in turned frames, 16 after each other.
  Eigen::VectorXf predict(const std::vector<LightSite>& sites) const;
  std::uint64_t memory() const;
  double seconds() const { return seconds_; }

 private:
  UnetTransfer(GeometryImage image, Unet net) : image_(std::move(image)), net_(std::move(net)) {}
  GeometryImage image_;
  Unet net_;
  Box box_;               ///< of the body at rest
  Eigen::VectorXf mean_;  ///< [vertex][coefficient]: where the image is coarse, the surface keeps that
  float scale_ = 1;       ///< of departures from it
  double seconds_ = 0;
};

}  // namespace rebake
