#pragma once

#include <functional>

#include "editor/actions/plain_report.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/features/distill/fuse.h"

namespace rebake {

/// The scene with all visible objects fused into one object with one decoder, as one plain folder contains it. Hidden
/// nodes stay. Colours include `lighting`, so the result has no light. Fills in the texel errors of `report`.
Scene plain_scene(const Scene& scene, const Lighting& lighting, const FuseOptions& options, PlainReport& report,
                  const Progress& progress);

/// As plain_scene(), but compares pictures of `picture_size`² pixels. If the worst object misses `options.psnr_db`, up
/// to two other candidates (pairs of fuse method and width) are fitted. Returns the one whose worst object has the
/// highest PSNR. Fills in `report`. If `renderer` throws DeviceError, calls `no_device` and returns the first candidate
/// unmeasured, or the best so far.
Scene best_plain_scene(const Scene& scene, const Lighting& lighting, const FuseOptions& options,
                       const std::function<Renderer&()>& renderer,
                       const std::function<void(const DeviceError&)>& no_device, PlainReport& report,
                       const Progress& progress, int picture_size = 800);

/// Intermediate data of plain_scene(), for trying several candidates. The constructor throws as composed() does, and
/// Error if an unsplit layout cannot contain all texels.
struct PlainSceneBuilder {
  PlainSceneBuilder(const Scene& scene, const Lighting& lighting, Layout layout, const Progress& progress);
  /// Trains and scores the candidates.
  const FusePlan& make_plan(const FuseOptions& options, const Progress& progress);
  /// The plain scene of one candidate; make_plan() must have been called.
  Scene scene(const Scene& original, std::size_t candidate, const FuseOptions& options, const Progress& progress);

  Composition composition;
  std::optional<VisibleDirections> sightlines;  ///< empty if the composition is exact
  std::optional<FusePlan> plan;                 ///< empty before make_plan()
};

/// The layout of all visible objects if it is the same, else split.
Layout common_layout(const Scene& scene);

}  // namespace rebake
