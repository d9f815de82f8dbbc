#include "editor/edits/select/select_floaters.h"

#include "editor/edits/describe_edit.h"
#include "mesh_ops/index/index.h"

namespace rebake {

Scene apply(const Scene& scene, const SelectFloaters& edit) {
  if (edit.at_most < 1) throw FieldError("at_most", "must be at least 1");
  const Connectivity joining = edit.joining.checked();
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
    SelectFloaters, "Selects floaters: small connected components of opaque triangles; check the count, then delete.",
    (auto& edit, auto& visit) {
      visit("node", edit.node, Need::optional,
            "only this node and its children; default: all visible, unlocked objects");
      visit("at_most", edit.at_most, Need::optional, "largest component that counts as a floater, in triangles");
      ConnectivityFields::fields(edit.joining, visit);
      visit("mode", edit.mode, Need::optional, "how to combine the result with the present selection");
    })

}  // namespace rebake
