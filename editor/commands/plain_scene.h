#pragma once

#include <functional>

#include "editor/commands/plain_report.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/features/fuse.h"

namespace rebake {

/// The scene with all that is visible as one object of one decoder, which one plain folder holds; hidden nodes stay as
/// they are. Colours are as `lighting` makes them, so that the result needs no light. Fills in what `report` says of
/// texels.
Scene plain_scene(const Scene& scene, const Lighting& lighting, const FuseOptions& options, PlainReport& report,
                  const Progress& progress);

/// The same, judged by pictures: when the worst object of the plan's choice misses `options.psnr_db` in them, other
/// candidates are made and the best is taken. Measures pictures of `picture_size` pixels a side into `report`, unless
/// `renderer` throws DeviceError, which `no_device` then gets.
Scene best_plain_scene(const Scene& scene, const Lighting& lighting, const FuseOptions& options,
                       const std::function<Renderer&()>& renderer,
                       const std::function<void(const DeviceError&)>& no_device, PlainReport& report,
                       const Progress& progress, int picture_size = 800);

/// What making it needs, to be kept while several ways are tried. Throws as composed() does, and Error where an unsplit
/// folder is too small.
struct PlainParts {
  PlainParts(const Scene& scene, const Lighting& lighting, Layout layout, const Progress& progress);
  const FusePlan& make_plan(const FuseOptions& options, const Progress& progress);
  /// The scene as one of the plan's candidates makes it.
  Scene scene(const Scene& original, std::size_t candidate, const FuseOptions& options, const Progress& progress);

  Composition composition;
  std::optional<Sightlines> sightlines;  ///< where something has to be fitted
  std::optional<FusePlan> plan;
};

/// The layout that all visible objects have, else split.
Layout common_layout(const Scene& scene);

}  // namespace rebake
