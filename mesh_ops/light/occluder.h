#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "mesh_ops/rays/scene_rays.h"
#include "mesh_ops/scene/object.h"

namespace rebake {

/// Something that shades: an object, and where it stands in the space that light is traced in.
struct Occluder {
  std::shared_ptr<const BakedObject> object;
  Affine to_frame;
};

/// Rays among them. What lies much farther than most of an object, such as a backdrop, shades nothing: it is what
/// shines.
SceneRays rays_among(const std::vector<Occluder>& occluders);

/// A hash of an object's triangles and all their texels: of what shades, and of what colours follow from. Like how far
/// an object shades, it is known as long as its arrays live.
std::uint64_t surface_hash(const BakedObject& object);

}  // namespace rebake
