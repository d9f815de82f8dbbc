#pragma once

#include <cstdint>
#include <vector>

#include "mesh_ops/light/learned/dprt_network.h"
#include "mesh_ops/light/learned/geometry_image.h"
#include "mesh_ops/light/learned/unet_trainer.h"

namespace rebake {

/// Deep precomputed radiance transfer as published, of a body that is laid out as a geometry image. UnetTransfer is
/// Rebake's variant.
class DprtTransfer {
 public:
  /// Training set that is filled pose by pose. learned() trains a network on it and throws Error without LibTorch.
  class Training {
   public:
    explicit Training(GeometryImage image) : image_(std::move(image)) {}
    /// `sites`, `transfer`: per vertex, in the body's space.
    void add(const std::vector<LightSite>& sites, const std::vector<sh::Coefficients>& transfer);
    DprtTransfer learned(UnetTraining options, const Progress& progress = {}) const;

   private:
    GeometryImage image_;
    std::vector<std::vector<LightSite>> texels_;  ///< [pose][texel]
    std::vector<std::vector<float>> planes_;      ///< [pose][16 × texels]
  };

  /// `seconds`: training time, without tracing. Throws std::invalid_argument for a chart that is not valid.
  DprtTransfer(const DiskChart& chart, std::size_t vertices, DprtNetwork net, double seconds);

  /// 16 coefficients per vertex, in the body's space.
  Eigen::VectorXf predict(const std::vector<LightSite>& sites) const;
  const DiskChart& chart() const { return image_.chart(); }
  const DprtNetwork& net() const { return net_; }
  double seconds() const { return seconds_; }
  std::uint64_t memory() const;

 private:
  GeometryImage image_;
  DprtNetwork net_;
  double seconds_;
};

}  // namespace rebake
