#include "editor/edits/shape/fill_holes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "editor/edits/describe_edit.h"
#include "editor/edits/shape/fill_report.h"
#include "mesh_ops/base/counted.h"

namespace rebake {

Outcome apply(const Scene& scene, const FillHoles& edit, const Progress& progress) {
  if (edit.longest < 3) throw FieldError("longest", "must be at least 3");
  const auto longest = static_cast<std::size_t>(edit.longest);
  Scene result = scene;
  Report report;
  std::vector<std::string> open;
  bool any = false;
  for (const PlacedNode& placed : objects_with_selection(scene, edit.node)) {
    const FilledHoles filled = filled_open_holes(*placed.node->object, *placed.node->selection, longest, progress);
    if (filled.holes == 0) {
      if (filled.unfilled() > 0)
        open.push_back(fmt::format("\"{}\": {} open: {}", placed.node->name,
                                   counted(filled.unfilled(), "border stays", "borders stay"),
                                   unfilled_words(filled, longest)));
      continue;
    }
    any = true;
    result = with_changed(result, placed.node->id, [&](Node& node) { set_filled(node, filled); });
    report_filling(placed, filled, report, longest);
  }
  if (!any)
    throw EditError(open.empty() ? "the selected triangles have no closed border: select all triangles around a hole"
                                 : fmt::format("{}", fmt::join(open, "; ")));
  for (const std::string& one : open) report.lines.push_back("note: " + one);
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
