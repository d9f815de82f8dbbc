#pragma once

#include "editor/gui/window/desk.h"
#include "render/graph/guides.h"

namespace rebake {

/// Colours on the triangles that are to be deformed, by how much of it each corner takes: strong where it is held.
class FalloffShade {
 public:
  /// Of the present scene; null without a falloff, and for more triangles than can be shaded at once. What was made
  /// last is kept.
  Guides::Triangles of(const Desk& desk, const std::vector<DeformTarget>& targets, double falloff);

 private:
  std::vector<NodePtr> roots_;
  std::vector<NodeRef> nodes_;
  double falloff_ = 0;
  Guides::Triangles made_;
};

}  // namespace rebake
