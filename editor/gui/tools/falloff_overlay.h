#pragma once

#include "editor/edits/deform/deforming.h"
#include "render/graph/guides.h"

namespace rebake {

/// Overlay that shows a deformation's falloff on the selected triangles: the less a corner will move, the more opaque.
class FalloffOverlay {
 public:
  /// Triangles of the overlay for a scene. Null without a falloff, for whole objects, and if objects with a
  /// selection have more than 100,000 triangles. Caches the last result.
  Guides::Triangles of(const Scene& scene, const std::vector<DeformTarget>& targets, double falloff);

 private:
  std::vector<NodePtr> roots_;
  std::vector<NodeRef> nodes_;
  double falloff_ = 0;      ///< scene units
  Guides::Triangles made_;  ///< cached result for the inputs above
};

}  // namespace rebake
