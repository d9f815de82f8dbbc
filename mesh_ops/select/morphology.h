#pragma once

#include "mesh_ops/index/edges.h"

namespace rebake {

/// Dilation: adds the triangles that share a welded vertex with the selection.
TriangleSet grown(const WeldedCorners& corners, const TriangleSet& selection);
/// Erosion: removes the triangles that share a welded vertex with unselected ones.
TriangleSet shrunk(const WeldedCorners& corners, const TriangleSet& selection);
/// Hole filling: adds the edge-connected components of unselected triangles that border the selection and have fewer
/// than `largest` triangles.
TriangleSet filled(const EdgeTable& edges, const TriangleSet& selection, std::size_t largest);

/// Connected component of a triangle, through shared welded vertices; ignores opacity.
TriangleSet connected_to(const WeldedCorners& corners, std::size_t triangle);
/// Triangles of `within` that are connected to one of `from`, through welded vertices of triangles in either set.
TriangleSet connected_within(const WeldedCorners& corners, const TriangleSet& within, const TriangleSet& from);

}  // namespace rebake
