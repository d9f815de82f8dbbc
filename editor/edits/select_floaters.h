#pragma once

#include "editor/edits/selecting.h"
#include "mesh_ops/select/index.h"

namespace rebake {

struct SelectFloaters {
  static constexpr const char* op = "select_floaters";
  static constexpr const char* help =
      "Selects small parts that hang together with nothing else, across opaque texels; look at the count, then delete.";
  std::optional<NodeRef> node;
  int at_most = 100;
  double tolerance = 0;
  double gap = 0;
  SelectMode mode = SelectMode::set;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("node", self.node, Need::optional, "only of this node and those inside it; left out: of all that is visible");
    visit("at_most", self.at_most, Need::optional, "triangles of a part that counts as floating");
    visit("tolerance", self.tolerance, Need::optional,
          "corners at most this far apart count as one, in the object's units; 0: only equal ones");
    visit("gap", self.gap, Need::optional,
          "opaque texels at most this far apart hang together too, in the object's units");
    visit("mode", self.mode, Need::optional, "how the result joins the present selection");
  }
};

inline Scene apply(const Scene& scene, const SelectFloaters& edit) {
  if (edit.at_most < 1) throw FieldError("at_most", "must be at least 1");
  if (edit.tolerance < 0) throw FieldError("tolerance", "must not be negative");
  if (edit.gap < 0) throw FieldError("gap", "must not be negative");
  return with_selected(scene, selectable(scene, edit.node), edit.mode, [&](const PlacedNode& placed) {
    const BakedObject& object = *placed.node->object;
    const auto parts = components_of(object, {edit.tolerance, edit.gap});
    const auto traits = traits_of(object);
    TriangleSet flags(object.triangle_count());
    // What has no opaque texel is invisible, not floating.
    for (std::size_t f = 0; f < flags.size(); ++f)
      flags[f] =
          (*traits)[f].opacity > 0 && parts->triangles_in[parts->part_of[f]] <= static_cast<std::uint32_t>(edit.at_most)
              ? 1
              : 0;
    return flags;
  });
}

}  // namespace rebake
