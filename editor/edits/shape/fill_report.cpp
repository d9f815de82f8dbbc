#include "editor/edits/shape/fill_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "editor/edits/scene_change.h"
#include "mesh_ops/base/counted.h"

namespace rebake {

void report_filling(const PlacedNode& placed, const FilledHoles& filled, Report& report, std::size_t longest) {
  const std::string& node = placed.node->name;
  report.lines.push_back(
      fmt::format("\"{}\": {}{} closed with {} of area {:.4g} and {}; colours at the border "
                  "differ by {:.1f} of "
                  "255 (root mean square) from those that continue",
                  node, filled.removed > 0 ? triangles_text(filled.removed) + " removed; " : "",
                  counted(filled.holes, "hole"), triangles_text(filled.triangles), patch_area(filled, placed.to_world),
                  counted(filled.texels, "texel"), 255 * filled.color_step));
  if (filled.open_edges > 0)
    report.lines.push_back(fmt::format("note: \"{}\": {} of the border form no closed loop and stay open", node,
                                       counted(filled.open_edges, "edge")));
  if (filled.unfilled() > 0)
    report.lines.push_back(fmt::format("note: \"{}\": {} open: {}", node,
                                       counted(filled.unfilled(), "hole stays", "holes stay"),
                                       unfilled_words(filled, longest)));
}

std::string unfilled_words(const FilledHoles& filled, std::size_t longest) {
  std::vector<std::string> reasons;
  if (filled.longer > 0)
    reasons.push_back(fmt::format("{} more than {} edges{}", counted(filled.longer, "has", "have"),
                                  std::min(longest, longest_loop),
                                  longest < longest_loop ? " (raise longest)" : ", the most that can be closed"));
  if (filled.untextured > 0) reasons.push_back(counted(filled.untextured, "has", "have") + " no opaque texels around");
  if (filled.crossing > 0) reasons.push_back(counted(filled.crossing, "crosses itself", "cross themselves"));
  return fmt::format("{}", fmt::join(reasons, ", "));
}

void set_filled(Node& node, const FilledHoles& filled) {
  for (auto& [stored, saved] : node.saved_selections) {
    // A patch amid selected triangles belongs to them: keyframed bends move it with them.
    std::vector<std::uint8_t> inside;
    for (const std::vector<std::uint32_t>& around : filled.around)
      inside.push_back(
          std::all_of(around.begin(), around.end(), [&](std::uint32_t f) { return (*saved)[f] != 0; }) ? 1 : 0);
    TriangleSet longer = *saved;
    for (const std::size_t hole : filled.hole_of) longer.push_back(inside[hole]);
    saved = std::make_shared<const TriangleSet>(std::move(longer));
  }
  node.object = filled.object;
  node.selection = nullptr;
}

}  // namespace rebake
