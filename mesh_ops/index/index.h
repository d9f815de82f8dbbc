#pragma once

#include "mesh_ops/base/progress.h"
#include "mesh_ops/index/array_cache.h"
#include "mesh_ops/index/components.h"
#include "mesh_ops/index/traits.h"
#include "mesh_ops/rays/ray_tree.h"
#include "mesh_ops/rays/scene_rays.h"
#include "mesh_ops/scene/scene.h"
#include "mesh_ops/texture/decoder_bounds.h"

namespace rebake {

// Cached indices of an object. Each is computed on first request and cached by the arrays that it depends on (see
// ArrayCache): moving vertices does not invalidate indices of texels, and vice versa. Thread-safe.

std::shared_ptr<const std::vector<TriangleTraits>> traits_of(const BakedObject& object);
/// `tolerance`: welding distance in object units.
std::shared_ptr<const WeldedCorners> corners_of(const BakedObject& object, double tolerance = 0);
std::shared_ptr<const EdgeTable> edges_of(const BakedObject& object, double tolerance = 0);
std::shared_ptr<const Components> components_of(const BakedObject& object, const Connectivity& joining = {});
std::shared_ptr<const RayTree> rays_of(const BakedObject& object);
/// Bounds of colours by which the frame plan skips effects, see decoder_bounds.h.
std::shared_ptr<const DirectionInfluence> direction_influence_of(const std::shared_ptr<const Decoder>& decoder);
std::shared_ptr<const std::optional<FeatureRange>> feature_range_of(
    const std::shared_ptr<const FeatureTexture>& texture);
/// As rays_of(), but null if the object's triangles are not indexed yet, for callers that must not wait.
std::shared_ptr<const RayTree> try_rays_of(const BakedObject& object);

/// Ray queries through placed objects; instance k is objects[k].
SceneRays rays_through(const std::vector<PlacedNode>& objects);

/// Computes traits, components and rays with default parameters, so that the first selection does not wait. Call it
/// outside the window's thread.
void prepare_index(const BakedObject& object, const Progress& progress = {});

/// The cache of all indices, with a budget of 1 GiB.
const ArrayCache& index_cache();

}  // namespace rebake
