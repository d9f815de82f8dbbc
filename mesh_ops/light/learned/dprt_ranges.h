#pragma once

#include <span>
#include <vector>

#include "mesh_ops/light/learned/dprt_network.h"

namespace rebake {

/// The ranges of training poses of a DprtNetwork.
class DprtRanges {
 public:
  DprtRanges();
  /// Adds a pose: the places of its texels, and their coefficients [16][texel].
  void add(const std::vector<Vec3>& places, std::span<const float> coefficients);
  /// The ranges so far. Those of coefficients have a margin of 5 % on both sides, so that the sigmoid reaches them.
  DprtNetwork::Ranges found() const;

 private:
  Box box_;
  DprtNetwork::Ranges seen_;
};

/// The outputs 0 … 1 that a network with these ranges should have for coefficients [16][texel].
std::vector<float> dprt_targets(std::span<const float> coefficients, const DprtNetwork::Ranges& ranges);

}  // namespace rebake
