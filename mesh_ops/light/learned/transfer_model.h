#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mesh_ops/light/learned/dprt_transfer.h"
#include "mesh_ops/light/learned/learned_transfer.h"
#include "mesh_ops/light/learned/unet_transfer.h"

namespace rebake {

/// A trained model of one body's transfer at a subset of its sites, the keys; other sites interpolate the keys.
struct TransferModel {
  std::uint64_t body = 0;   ///< surface_hash() of the body
  std::uint64_t sites = 0;  ///< number of sites
  std::string poses_from;   ///< description of the deforming edit, for users
  int poses = 0, rays = 0;  ///< training poses, and rays per site
  double tracing_seconds = 0;
  std::vector<std::uint32_t> keys;  ///< site indices
  std::vector<float> facing;        ///< per key: facing_of()
  /// Linear model of the keys (rotated_linear). With a network, only its pose space, which gives the trusted range, and
  /// its error are kept.
  LearnedTransfer learned;
  /// Networks that predict instead of `learned`, at most one; their vertices are the keys.
  std::optional<UnetTransfer> net;
  std::optional<DprtTransfer> published;
  double net_error = 0;      ///< relative error of the network on the held-out poses
  double turning_error = 0;  ///< the same by rotation alone; 0 if an older file does not contain it
  /// Relative error on the held-out poses.
  double error() const { return has_network() ? net_error : learned.held_back_error; }
  bool has_network() const { return net || published; }
  std::uint64_t memory() const;
  double training_seconds() const;  ///< without tracing

  /// 16 coefficients per key in rotated frames. `place`: the pose in pose space; `keys_there`, `turns`: the key sites
  /// in that pose, and the rotations of the surface around them since rest.
  Eigen::VectorXf predict(const PoseSpace::Place& place, const std::vector<LightSite>& keys_there,
                          const std::vector<Mat3>& turns) const;
};

/// Serialised form: a line of human-readable JSON, then numbers, then a hash over all.
std::string bytes_of(const TransferModel& model);
/// Parses the serialised form. Throws Error that states the fault.
TransferModel transfer_model_of(std::string_view bytes);
/// Whether a file is a transfer model of any version, even a damaged one.
bool is_transfer_model(std::string_view bytes);

/// Cache key of a body's model (Results).
std::string transfer_model_key(const BakedObject& body, std::size_t sites);

}  // namespace rebake
