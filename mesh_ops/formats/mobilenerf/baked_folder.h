#pragma once

#include <filesystem>
#include <memory>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/formats/mobilenerf/baked_layout.h"
#include "mesh_ops/scene/object.h"

namespace rebake {

/// Properties that the files of a folder do not state.
struct ReadOptions {
  ReadOptions(Axes stated = Axes::y_up, Dialect known = {}) : axes(stated), dialect(known) {}
  Axes axes;
  Dialect dialect;
};

/// Reads a MobileNeRF folder of any layout, also one that other tools have changed; Origin::assumptions lists skipped
/// parts and decisions. Its files do not state axes and dialect. Throws FileError.
std::shared_ptr<const BakedObject> read_baked_folder(const std::filesystem::path& folder, const ReadOptions& options,
                                                     const Progress& progress = {});

}  // namespace rebake
