#include "editor/edits/select/select_floaters.h"

#include "editor/edits/describe.h"
#include "mesh_ops/index/index.h"

namespace rebake {

Scene apply(const Scene& scene, const SelectFloaters& edit) {
  if (edit.at_most < 1) throw FieldError("at_most", "must be at least 1");
  const Joining joining = edit.joining.checked();
  return with_selected(scene, selectable(scene, edit.node), edit.mode, [&](const PlacedNode& placed) {
    const BakedObject& object = *placed.node->object;
    const auto parts = components_of(object, joining);
    const auto traits = traits_of(object);
    TriangleSet flags(object.triangle_count());
    // Fully transparent triangles are invisible, so they do not count as floaters.
    for (std::size_t f = 0; f < flags.size(); ++f)
      flags[f] =
          (*traits)[f].opacity > 0 && parts->triangles_in[parts->part_of[f]] <= static_cast<std::uint32_t>(edit.at_most)
              ? 1
              : 0;
    return flags;
  });
}

REBAKE_DESCRIBE_EDIT(
    SelectFloaters,
    "Selects small parts that hang together with nothing else, across opaque texels; look at the count, then delete.",
    (auto& edit, auto& visit) {
      visit("node", edit.node, Need::optional,
            "only of this node and those inside it; left out: of all that is visible and not locked");
      visit("at_most", edit.at_most, Need::optional, "triangles of a part that counts as floating");
      JoiningFields::fields(edit.joining, visit);
      visit("mode", edit.mode, Need::optional, "how the result joins the present selection");
    })

}  // namespace rebake
