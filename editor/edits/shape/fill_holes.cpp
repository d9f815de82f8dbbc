#include "editor/edits/shape/fill_holes.h"

#include <fmt/format.h>

#include "editor/edits/describe_edit.h"
#include "editor/edits/shape/fill_report.h"

namespace rebake {

Outcome apply(const Scene& scene, const FillHoles& edit, const Progress& progress) {
  if (edit.longest < 3) throw FieldError("longest", "must be at least 3");
  Scene result = scene;
  Report report, skipped;
  std::size_t holes = 0, longer = 0;
  for (const PlacedNode& placed : objects_with_selection(scene, edit.node)) {
    const FilledHoles filled = filled_open_holes(*placed.node->object, *placed.node->selection,
                                                 static_cast<std::size_t>(edit.longest), progress);
    holes += filled.holes;
    longer += filled.unfilled;
    if (filled.holes == 0) {
      if (filled.unfilled > 0) skipped.lines.push_back(unfilled_words(placed.node->name, filled.unfilled));
      continue;
    }
    result = with_changed(result, placed.node->id, [&](Node& node) { set_filled(node, filled); });
    report_filling(placed.node->name, filled, report);
  }
  if (holes == 0)
    throw EditError(longer > 0
                        ? fmt::format("{} borders of the selected triangles are longer than {} edges: raise longest",
                                      longer, edit.longest)
                        : "the selected triangles have no closed border: select all triangles around a hole");
  report.lines.insert(report.lines.end(), skipped.lines.begin(), skipped.lines.end());
  return {std::move(result), std::move(report)};
}

REBAKE_DESCRIBE_EDIT(
    FillHoles,
    "Closes holes in the surface whose triangles around are all selected; shape and features continue smoothly from "
    "them.",
    (auto& edit, auto& visit) {
      visit("node", edit.node, Need::optional, "only this node; default: all visible, unlocked objects");
      visit("longest", edit.longest, Need::optional,
            "edges of the longest border to close; the outline of a surface is longer");
    })

}  // namespace rebake
