#pragma once

#include <vector>

#include "editor/edits/deform/deforming.h"
#include "mesh_ops/deform/bends/spine.h"

namespace rebake {

/// Spine of the targets' opaque triangles, each represented by its centroid, weighted by area; the rest of their
/// objects tells where they are attached. Its length is 0 if the triangles have no extent. Throws as deform_set().
Spine spine_of_targets(const Scene& scene, const std::vector<DeformTarget>& targets);

}  // namespace rebake
