#pragma once

#include <utility>

#include "mesh_ops/light/learned/geometry_image.h"

namespace rebake {

/// Cuts a mesh to a disk along edges of high curvature and parametrises it over the unit square, with the boundary by
/// arc length, that of an open mesh from its sharpest corner on: harmonic weights (Eck et al. 1995), or mean value
/// weights (Floater 2003) if those would fold. A closed mesh is cut through its `tips`, the vertices farthest from each
/// other; handles and additional boundary loops are cut too. Throws Error if the mesh is not connected, not manifold or
/// not oriented.
DiskChart disk_chart(const ProxyMesh& mesh, int tips = 6);

/// The cut edges of disk_chart(), as vertex pairs, lower index first.
std::vector<std::pair<std::uint32_t, std::uint32_t>> seams_of(const ProxyMesh& mesh, int tips);
/// The mesh cut along `seams`; `uvs` is empty.
DiskChart cut_along(const ProxyMesh& mesh, const std::vector<std::pair<std::uint32_t, std::uint32_t>>& seams);

}  // namespace rebake
