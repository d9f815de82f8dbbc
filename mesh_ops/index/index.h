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

// What selecting on an object needs to know of it. Each is computed when it is first asked for and kept by the object's
// arrays (see ArrayCache): what moves vertices keeps what is known of texels, and the other way round. Callable from
// any thread.

std::shared_ptr<const std::vector<TriangleTraits>> traits_of(const BakedObject& object);
std::shared_ptr<const WeldedCorners> corners_of(const BakedObject& object, double tolerance = 0);
std::shared_ptr<const EdgeTable> edges_of(const BakedObject& object, double tolerance = 0);
std::shared_ptr<const Components> components_of(const BakedObject& object, const Joining& joining = {});
std::shared_ptr<const RayTree> rays_of(const BakedObject& object);
/// What frames may leave out, see decoder_bounds.h.
std::shared_ptr<const DirectionUse> direction_use_of(const std::shared_ptr<const Decoder>& decoder);
std::shared_ptr<const std::optional<FeatureRange>> feature_range_of(
    const std::shared_ptr<const FeatureTexture>& texture);
/// Null where they are not there yet: for who must not wait.
std::shared_ptr<const RayTree> rays_if_there(const BakedObject& object);

/// Rays through placed objects, in their order.
SceneRays rays_through(const std::vector<PlacedNode>& objects);

/// Computes all of the above with their defaults, to be called off the window's thread before anything is selected.
void prepare_index(const BakedObject& object, const Progress& progress = {});

/// Where all of them are kept: one gigabyte at most.
const ArrayCache& index_cache();

}  // namespace rebake
