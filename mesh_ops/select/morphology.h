#pragma once

#include "mesh_ops/index/edges.h"

namespace rebake {

/// The selection and the triangles that share a place with it.
TriangleSet grown(const WeldedCorners& corners, const TriangleSet& selection);
/// The selection without the triangles that share a place with others.
TriangleSet shrunk(const WeldedCorners& corners, const TriangleSet& selection);
/// The selection and the islands inside it: unselected triangles, joined through shared edges, that border selected
/// ones and are fewer than `largest`.
TriangleSet filled(const EdgeTable& edges, const TriangleSet& selection, std::size_t largest);

/// Triangles that hang together with the given one through places they share, transparent ones too.
TriangleSet joined_to(const WeldedCorners& corners, std::size_t triangle);
/// Of the triangles `within`, those that hang together with one of `from` through places they share.
TriangleSet joined_within(const WeldedCorners& corners, const TriangleSet& within, const TriangleSet& from);

}  // namespace rebake
