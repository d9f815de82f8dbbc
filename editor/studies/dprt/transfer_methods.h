#pragma once

#include <array>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "editor/studies/dprt/traced_frames.h"
#include "editor/studies/study.h"
#include "mesh_ops/light/learned/dprt_network.h"

namespace rebake {

/// A method that predicts the radiance transfer of a pose of the texels.
struct DprtMethod {
  std::string name;
  /// Coefficients [16][texel] in the body's space. `sites`: of the pose; `frame`: its positions.
  std::function<std::vector<float>(const FrameSites& sites, const std::vector<Vec3>& frame)> predict;
  /// What of a pose predict() needs, which counts as a part of its time. Tracing finds everything itself.
  enum class Needs { positions, normals, rotations };
  Needs needs = Needs::positions;
  double bytes = 0;       ///< size of the file of the published network, of the others in memory; 0: stores nothing
  double parameters = 0;  ///< number of learned values; 0: learns nothing
  double minutes = 0;     ///< time of learning over all interruptions, without tracing
  double loss = nan, held_out_loss = nan;  ///< L1 losses of the network's outputs
  static constexpr double nan = std::numeric_limits<double>::quiet_NaN();
};

/// Per epoch: its number, the losses of the training and the held-out frames, minutes of training since the start.
using DprtCurve = std::vector<std::array<double, 4>>;

/// The transfer at rest, as it is and rotated with the surface.
std::vector<DprtMethod> rest_methods(const TracedFrames& traced, int rays);
/// Linear models in the body's space (MoMoPRT) and in rotated frames.
std::vector<DprtMethod> linear_methods(const TracedFrames& traced, const Progress& progress);
/// The published network. `base`: path of its checkpoint, curve and file, without their endings; they are kept.
DprtMethod published_network(const TracedFrames& traced, const DprtOptions& options, const std::string& base,
                             DprtCurve& curve, const Progress& progress);
/// Rebake's own variant: added skip connections, deviations from the mean in rotated frames. `base`: as above.
DprtMethod rotated_network(const TracedFrames& traced, const DprtOptions& options, const std::string& base,
                           const Progress& progress);
/// Tracing with this number of rays per texel.
DprtMethod traced_method(const TracedFrames& traced, int rays);

}  // namespace rebake
