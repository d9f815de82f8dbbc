#pragma once

#include "editor/edits/selecting.h"
#include "mesh_ops/select/index.h"

namespace rebake {

struct Grow {
  static constexpr const char* op = "grow";
  static constexpr const char* help = "Adds the triangles that share a corner with the selection.";
  std::optional<NodeRef> node;
  int steps = 1;
  double tolerance = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("node", self.node, Need::optional, "only of this node and those inside it; left out: of all that is visible");
    visit("steps", self.steps, Need::optional, "how often");
    visit("tolerance", self.tolerance, Need::optional,
          "corners at most this far apart count as one, in the object's units; 0: only equal ones");
  }
};

inline Scene apply(const Scene& scene, const Grow& edit) {
  if (edit.steps < 1) throw FieldError("steps", "must be at least 1");
  if (edit.tolerance < 0) throw FieldError("tolerance", "must not be negative");
  with_selection(scene, edit.node);
  return with_selected(scene, selectable(scene, edit.node), SelectMode::set, [&](const PlacedNode& placed) {
    const auto corners = corners_of(*placed.node->object, edit.tolerance);
    TriangleSet flags = selection_of(placed);
    for (int step = 0; step < edit.steps; ++step) {
      TriangleSet next = grown(*corners, flags);
      if (next == flags) break;
      flags = std::move(next);
    }
    return flags;
  });
}

}  // namespace rebake
