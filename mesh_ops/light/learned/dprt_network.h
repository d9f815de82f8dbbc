#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "mesh_ops/light/learned/unet.h"
#include "mesh_ops/light/transport/light_sites.h"
#include "mesh_ops/light/transport/spherical_harmonics.h"

namespace rebake {

/// Deep precomputed radiance transfer as published (Li, Wiedemann and Mitchell 2018): a U-Net maps a geometry image of
/// the pose, positions and normals per texel, to the coefficients of the transfer function in the body's space. They
/// are mapped linearly from 0 … 1, the range of the network's sigmoid. It knows nothing of the object but its weights.
class DprtNetwork {
 public:
  /// Ranges that normalise positions and coefficients.
  struct Ranges {
    Vec3 center = Vec3::Zero();                  ///< of the positions
    double reach = 1;                            ///< half the longest side of their box, which becomes 1
    std::array<float, sh::count> low{}, high{};  ///< coefficients that become 0 and 1
  };

  /// Throws std::invalid_argument for sizes that do not fit and ranges that are empty or not finite.
  DprtNetwork(Unet net, const Ranges& ranges);

  /// The network's input: planes [6][row][column] of positions and unit normals of the texels' sites, row by row.
  static std::vector<float> image_of(const std::vector<LightSite>& sites, const Ranges& ranges);
  /// Coefficients [16][row][column] for sites in the order of the texels. The same bits on every processor.
  std::vector<float> predict(const std::vector<LightSite>& sites) const;

  const Unet& net() const { return net_; }
  const Ranges& ranges() const { return ranges_; }

  /// Serialised form: a line of JSON, the ranges and weights as 32-bit floats, and a hash. It holds only what predicts.
  std::string bytes() const;
  /// Throws Error that states the fault.
  static DprtNetwork parsed(std::string_view bytes);

 private:
  Unet net_;
  Ranges ranges_;
};

}  // namespace rebake
