#pragma once

#include "mesh_ops/base/progress.h"
#include "mesh_ops/reconstruction/reconstruction.h"
#include "mesh_ops/scene/object.h"

namespace rebake {

struct BakeReconstructionOptions {
  int samples = 16;          ///< texels between the corners of a quad, per axis (published: 16)
  bool visible_only = true;  ///< leaves out triangles that no view sees
  bool views_around = true;  ///< also looks from 300 places around an object, as published
};

/// What bake() left out.
struct BakeReconstructionCounts {
  std::size_t quads = 0;          ///< with an opaque texel
  std::size_t visible_quads = 0;  ///< of these, with a triangle that is visible
  std::size_t opaque_texels = 0;  ///< of the visible quads
};

/// Stage 3 of MobileNeRF: the visible triangles of the grid as an object, with textures of (samples + 1)² texels per
/// quad. A triangle is visible if a ray through a pixel of a photograph, or of views on a sphere around an object, hits
/// it first. Throws Error if nothing is opaque.
std::shared_ptr<const BakedObject> bake(const Reconstruction& trained, const BakeReconstructionOptions& options,
                                        BakeReconstructionCounts& counts, const Progress& progress);

}  // namespace rebake
