#pragma once

#include "mesh_ops/base/progress.h"
#include "mesh_ops/scene/object.h"

namespace rebake {

/// Result of filling the holes of an object.
struct FilledHoles {
  std::shared_ptr<const BakedObject> object;  ///< the patches are its last texture set; null if nothing is left
  std::size_t removed = 0;                    ///< triangles
  std::size_t holes = 0, triangles = 0;       ///< closed holes, and their triangles
  std::uint64_t texels = 0;                   ///< of the patches' triangles
  /// Root mean square difference of display colours (0 … 1) between the texels at the borders and the colours that the
  /// patches continue from there, seen along the patches' normals.
  double color_step = 0;
  std::size_t open_edges = 0;  ///< border edges that form no loop
  std::size_t longer = 0;      ///< loops with more edges than wanted, or than longest_loop
  /// Loops around which UVs have no area, or no texel is opaque, and loops that cross themselves.
  std::size_t untextured = 0, crossing = 0;
  std::size_t unfilled() const { return longer + untextured + crossing; }
  /// Per triangle of the patches: the closed hole that it belongs to.
  std::vector<std::size_t> hole_of;
  /// Per closed hole: the triangles around it, numbered without the removed ones.
  std::vector<std::vector<std::uint32_t>> around;
};

/// Area of the patches where `to_world` places the object, in square units there.
double patch_area(const FilledHoles& filled, const Affine& to_world);

/// Removes the flagged triangles and closes the holes that they leave. Surfaces continue smoothly (hole_patch()).
/// Features are interpolated harmonically from the opaque texels at the border, so the patches keep their view
/// dependence; they have no detail of their own. Texels are as large as those at the border.
FilledHoles filled_holes(const BakedObject& object, const TriangleSet& removed, const Progress& progress = {});

/// Closes holes that were there before: the open borders of the flagged triangles of at most `longest` edges. Removes
/// nothing. Longer borders count as unfilled.
FilledHoles filled_open_holes(const BakedObject& object, const TriangleSet& flagged, std::size_t longest,
                              const Progress& progress = {});

}  // namespace rebake
