#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "mesh_ops/rays/scene_rays.h"
#include "mesh_ops/scene/object.h"

namespace rebake {

/// An object that occludes light.
struct Occluder {
  std::shared_ptr<const BakedObject> object;
  Affine to_frame;  ///< from object space to the space in which light is traced
};

/// A ray tracer over the occluders. Triangles much farther away than most of their object, such as a backdrop, do not
/// occlude: they are light sources.
SceneRays rays_among(const std::vector<Occluder>& occluders);

/// Hash of an object's triangles and texels, which determine its occlusion and its colours. Cached as long as its
/// arrays live.
std::uint64_t surface_hash(const BakedObject& object);

}  // namespace rebake
