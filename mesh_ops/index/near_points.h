#pragma once

#include <cstdint>
#include <vector>

#include "mesh_ops/base/types.h"
#include "mesh_ops/base/union_find.h"

namespace rebake {

/// Joins in `parts` the owners of points that are at most `reach` apart. `owner`: element of `parts` per point;
/// `origin`: any point near them. Points in the same grid cell are joined without comparison, so dense clouds cost no
/// more than sparse ones.
void join_near(UnionFind& parts, const std::vector<Vec3>& points, const std::vector<std::uint32_t>& owner, double reach,
               const Vec3& origin);

}  // namespace rebake
