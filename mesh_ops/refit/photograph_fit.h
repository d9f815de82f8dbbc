#pragma once

#include <map>
#include <memory>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/rays/scene_rays.h"
#include "mesh_ops/scene/scene.h"

namespace rebake {

/// A photograph by a camera without lens distortion, with square pixels and a central principal point.
struct FitPhotograph {
  Camera camera;  ///< planes are not used
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;    ///< display colours, row by row from the top
  std::vector<std::uint8_t> valid;  ///< per pixel: 0 for pixels that show nothing of the scene
};

/// A node whose texels are fitted.
struct FitTarget {
  PlacedNode placed;
  TriangleSet triangles;  ///< a flag per triangle: those whose texels change
};

struct FitOfPhotographsOptions {
  bool decoder = false;           ///< fits decoders too; always where an object has no network
  int epochs = 40;                ///< of a fit with decoder, see FitOptions
  std::size_t observations = 24;  ///< photographs of a texel that count: random ones, better views more often
};

struct FitOfPhotographs {
  /// The objects that changed, by the targets' nodes. Targets with the same object and triangles share one.
  std::map<NodeId, std::shared_ptr<const BakedObject>> objects;
  std::size_t seen = 0,
              unseen = 0;        ///< texels of the targets that photographs see, and others, which keep their colours
  double before = 0, after = 0;  ///< root mean square errors of display colours over all observations, 0 … 1
};

/// Fits features (and decoders) of texels to the photographs that see them. A photograph sees a texel if nothing of
/// `occluders` lies between, and if all four pixels around the texel show the texel's surface. Texels that none sees so
/// are fitted to pixels that show it partly. Pixels that cover more than 1/16 of the targets' diagonal show nothing.
/// Texels that no photograph sees keep their features; with a new decoder they are fitted to their present colours.
/// Deterministic. Throws Cancelled.
FitOfPhotographs fit_to_photographs(const std::vector<FitTarget>& targets, const SceneRays& occluders,
                                    const std::vector<FitPhotograph>& photographs,
                                    const FitOfPhotographsOptions& options, const Progress& progress);

}  // namespace rebake
