#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "mesh_ops/light/learnt_transfer.h"
#include "mesh_ops/light/turned_light.h"
#include "mesh_ops/light/unet_transfer.h"

namespace rebake {

/// What was learnt of one body's transfer: at some of its sites, the keys, from which the others take theirs.
struct TransferModel {
  std::uint64_t body = 0;   ///< hash of what shades (surface_hash)
  std::uint64_t sites = 0;  ///< how many it had
  std::string poses_from;   ///< what moved it, for people
  int poses = 0, rays = 0;  ///< that it was learnt from
  double tracing_seconds = 0;
  std::vector<std::uint32_t> keys;  ///< numbers of sites
  std::vector<float> facing;        ///< of the keys, what showed (facing_of)
  LearntTransfer learnt;            ///< of the keys: TransferWay::turned_linear; with a net its range is what counts
  std::optional<UnetTransfer> net;  ///< then it is what predicts, its vertices are the keys
  double net_error = 0;             ///< relative, of the poses held back
  double turning_error = 0;         ///< of these, when only turned along; 0 where an older file does not tell
  /// Relative, of the poses held back, by what predicts.
  double error() const { return net ? net_error : learnt.held_back_error; }

  /// Coefficients of each key in turned frames, 16 after each other, in a pose: where it lies among those learnt from,
  /// and the sites of the keys there.
  Eigen::VectorXf predict(const PoseSpace::Place& place, const std::vector<LightSite>& keys_there) const;
};

struct TransferModelOptions {
  int poses = 200, rays = 128;
  std::size_t keys = 4096;
  /// Deep transfer: a U-Net on an image of a wrap of this coarseness or coarser (body_image). It learns from seven
  /// poses of eight.
  std::optional<UnetTraining> net{};
  double coarseness = 0.03;
};
/// Learns from poses of the object that `start` is of, which must be as its light was baked. `pose(k)` moves its
/// triangles, the same way for the same number. Throws Error for an object that edits moved already, for poses of other
/// triangles, and where a net is wanted without LibTorch.
TransferModel learnt_model(const TurnedLight& start,
                           const std::function<std::shared_ptr<const BakedObject>(int k)>& pose,
                           const TransferModelOptions& options, const Progress& progress = {});

/// As files and stores hold it: a line of JSON for people, then numbers, then a hash of all.
std::string bytes_of(const TransferModel& model);
/// Throws Error, saying what is wrong.
TransferModel transfer_model_of(std::string_view bytes);

/// Where the model of a body is kept (Results).
std::string transfer_model_key(const BakedObject& body, std::size_t sites);

}  // namespace rebake
