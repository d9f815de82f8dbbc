#pragma once

#include "editor/commands/plain_report.h"
#include "mesh_ops/features/fuse.h"

namespace rebake {

/// The scene with all that is visible as one object of one decoder, which one plain folder holds; hidden nodes stay as
/// they are. Fills in what `report` says of texels.
Scene plain_scene(const Scene& scene, const FuseOptions& options, PlainReport& report, const Progress& progress);

/// The layout that all visible objects have, else split.
Layout common_layout(const Scene& scene);

}  // namespace rebake
