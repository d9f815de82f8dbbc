#pragma once

#include <functional>
#include <memory>

#include "mesh_ops/scene/light.h"
#include "mesh_ops/scene/scene.h"

namespace rebake::test {

/// A bilinear patch: corners at (u, v) = (0, 0), (1, 0), (0, 1), (1, 1); its normal is ∂u × ∂v.
struct LitQuad {
  Vec3 corners[4];
  int columns = 1, rows = 1;  ///< quads that it is cut into
};
LitQuad flat_quad(const Vec3& corner, const Vec3& along_u, const Vec3& along_v, int columns = 1, int rows = 1);
/// Six of them, outwards.
std::vector<LitQuad> box_quads(const Vec3& low, const Vec3& high, int cuts = 1);

/// An object whose texels show linear colours, the same from everywhere, within what 8 bits hold (2 %): 17 × 17 texels
/// a quad, all opaque.
std::shared_ptr<const BakedObject> lit_object(const std::vector<LitQuad>& quads,
                                              const std::function<Radiance(const Vec3& position)>& color);

}  // namespace rebake::test
