#pragma once

#include <functional>
#include <memory>

#include "mesh_ops/scene/scene.h"
#include "mesh_ops/scene/scene_light.h"

namespace rebake::test {

/// A bilinear patch: corners at (u, v) = (0, 0), (1, 0), (0, 1), (1, 1); its normal is ∂u × ∂v.
struct LitQuad {
  Vec3 corners[4];
  int columns = 1, rows = 1;  ///< number of quads along u and v
};
LitQuad flat_quad(const Vec3& corner, const Vec3& along_u, const Vec3& along_v, int columns = 1, int rows = 1);
/// The six sides of a box with outward normals, each with `cuts` × `cuts` quads.
std::vector<LitQuad> box_quads(const Vec3& low, const Vec3& high, int cuts = 1);

/// An object with the given linear colours, the same from all directions, up to the precision of 8 bits (2 %). Each
/// quad has 17 × 17 texels, all opaque.
std::shared_ptr<const BakedObject> lit_object(const std::vector<LitQuad>& quads,
                                              const std::function<Radiance(const Vec3& position)>& color);

}  // namespace rebake::test
