#include "editor/edits/select/select_connected.h"

#include "editor/edits/describe_edit.h"
#include "mesh_ops/index/index.h"

namespace rebake {

Scene apply(const Scene& scene, const SelectConnected& edit) {
  const Connectivity joining = edit.joining.checked();
  std::vector<PlacedNode> targets = selectable(scene, edit.node);
  std::vector<TriangleSet> from;
  if (edit.point) {
    const NearestTriangle nearest = nearest_triangle(targets, *edit.point, true);
    for (const PlacedNode& placed : targets) from.emplace_back(placed.node->object->triangle_count(), 0);
    if (!from[nearest.target].empty()) from[nearest.target][nearest.triangle] = 1;
  } else {
    objects_with_selection(scene, edit.node);
    for (const PlacedNode& placed : targets) from.push_back(selection_of(placed));
  }
  std::size_t k = 0;
  return with_selected(scene, targets, edit.mode, [&](const PlacedNode& placed) {
    const TriangleSet& start = from[k++];
    if (count(start) == 0) return start;
    const auto parts = components_of(*placed.node->object, joining);
    std::vector<std::uint8_t> wanted(parts->triangles_in.size(), 0);
    for (std::size_t f = 0; f < start.size(); ++f)
      if (start[f] != 0) wanted[parts->part_of[f]] = 1;
    TriangleSet flags(start.size());
    for (std::size_t f = 0; f < flags.size(); ++f) flags[f] = wanted[parts->part_of[f]];
    return flags;
  });
}

REBAKE_DESCRIBE_EDIT(
    SelectConnected,
    "Selects the connected components (triangles that share an edge, opaque along it) with the triangle nearest to a "
    "point, or with the present selection.",
    (auto& edit, auto& visit) {
      visit("node", edit.node, Need::optional,
            "only this node and its children; default: all visible, unlocked objects");
      visit("point", edit.point, Need::optional,
            "world point near an opaque triangle; default: start from the present selection");
      ConnectivityFields::fields(edit.joining, visit);
      visit("mode", edit.mode, Need::optional, "how to combine the result with the present selection");
    })

}  // namespace rebake
