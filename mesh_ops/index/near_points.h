#pragma once

#include <cstdint>
#include <vector>

#include "mesh_ops/base/types.h"
#include "mesh_ops/base/union_find.h"

namespace rebake {

/// Joins in `parts` the owners of points that are at most `reach` apart. `origin` is any point near them. Dense clouds
/// cost no more than sparse ones: what shares a cell of a grid is joined without being compared.
void join_near(UnionFind& parts, const std::vector<Vec3>& points, const std::vector<std::uint32_t>& owner, double reach,
               const Vec3& origin);

}  // namespace rebake
