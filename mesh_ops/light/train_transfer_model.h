#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/light/learned/transfer_model.h"
#include "mesh_ops/light/relight/drag_light.h"

namespace rebake {

/// Size of a transfer model, and effort of its training.
struct TransferModelOptions {
  int poses = 200, rays = 128;
  std::size_t keys = 4096;
  /// Deep transfer: a U-Net on a geometry image of a wrap of this coarseness or coarser (body_image), trained on seven
  /// of eight poses.
  std::optional<UnetTraining> net{};
  bool published = false;  ///< with `net`: the network as published (DprtTransfer) instead of Rebake's (UnetTransfer)
  double coarseness = 0.03;
};
/// Trains a model on poses of the object of `start`, which must be unedited. `pose(k)` returns the object in pose k,
/// deterministically. Throws Error for an edited object, for poses with other triangles, and for a network without
/// LibTorch.
TransferModel trained_model(const DragLight& start,
                            const std::function<std::shared_ptr<const BakedObject>(int k)>& pose,
                            const TransferModelOptions& options, const Progress& progress = {});

}  // namespace rebake
