#include "editor/edits/shape/delete_and_fill.h"

#include <fmt/format.h>

#include "editor/edits/describe_edit.h"
#include "editor/edits/shape/fill_report.h"

namespace rebake {

Outcome apply(const Scene& scene, const DeleteAndFill& edit, const Progress& progress) {
  Scene result = scene;
  Report report;
  for (const PlacedNode& placed : objects_with_selection(scene, edit.node)) {
    const TriangleSet& selection = *placed.node->selection;
    const FilledHoles filled = filled_holes(*placed.node->object, selection, progress);
    const std::string& name = placed.node->name;
    if (!filled.object)
      throw EditError(fmt::format("\"{}\": all triangles are selected, so no border is left to fill from", name));
    if (filled.holes == 0)
      throw EditError(
          fmt::format("\"{}\": the selected triangles share no closed border with opaque ones: grow the "
                      "selection up to the surface around, or delete them",
                      name));
    result = with_changed(result, placed.node->id, [&](Node& node) {
      keep_triangles(node, selection, false);
      set_filled(node, filled);
    });
    report_filling(placed, filled, report);
  }
  return {std::move(result), std::move(report)};
}

std::string done_words(const DeleteAndFill& /*edit*/) { return "Deleted and filled"; }

REBAKE_DESCRIBE_EDIT(
    DeleteAndFill,
    "Deletes the selected triangles and closes the holes that they leave: the surface and its features continue "
    "smoothly "
    "from the opaque triangles around.",
    (auto& edit, auto& visit) {
      visit("node", edit.node, Need::optional, "only this node; default: all visible, unlocked objects");
    })

}  // namespace rebake
