#pragma once

#include <utility>

#include "mesh_ops/light/geometry_image.h"

namespace rebake {

/// Cuts a mesh open until it is a disk, along the edges where it is bent most, and lays it out on the square, its
/// border by arc length: harmonic (Eck et al. 1995), or by mean values (Floater 2003) where that would fold. A mesh
/// without a border is cut through its `tips`, the vertices farthest from each other; handles and several borders are
/// cut open, too. Throws Error, saying what is wrong, for a mesh that is not one piece, not manifold or not oriented.
DiskChart disk_chart(const ProxyMesh& mesh, int tips = 6);

/// The edges, as pairs of vertices, lower first, along which disk_chart cuts.
std::vector<std::pair<std::uint32_t, std::uint32_t>> seams_of(const ProxyMesh& mesh, int tips);
/// The mesh cut along edges; `uvs` are left empty.
DiskChart cut_along(const ProxyMesh& mesh, const std::vector<std::pair<std::uint32_t, std::uint32_t>>& seams);

}  // namespace rebake
