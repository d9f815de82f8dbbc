#include "editor/edits/select/select_connected.h"

#include "editor/edits/describe.h"
#include "mesh_ops/index/index.h"

namespace rebake {

Scene apply(const Scene& scene, const SelectConnected& edit) {
  const Joining joining = edit.joining.checked();
  std::vector<PlacedNode> targets = selectable(scene, edit.node);
  std::vector<TriangleSet> from;
  if (edit.point) {
    const NearestTriangle nearest = nearest_triangle(targets, *edit.point, true);
    for (const PlacedNode& placed : targets) from.emplace_back(placed.node->object->triangle_count(), 0);
    if (!from[nearest.target].empty()) from[nearest.target][nearest.triangle] = 1;
  } else {
    with_selection(scene, edit.node);
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
    "Selects the connected parts (triangles that share an edge, opaque along it) that hold the triangle nearest to a "
    "point, or the present selection.",
    (auto& edit, auto& visit) {
      visit("node", edit.node, Need::optional,
            "only of this node and those inside it; left out: of all that is visible and not locked");
      visit("point", edit.point, Need::optional,
            "world point, near a triangle that shows something; left out: from the present selection");
      JoiningFields::fields(edit.joining, visit);
      visit("mode", edit.mode, Need::optional, "how the result joins the present selection");
    })

}  // namespace rebake
