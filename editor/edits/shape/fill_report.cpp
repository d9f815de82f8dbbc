#include "editor/edits/shape/fill_report.h"

#include <fmt/format.h>

namespace rebake {

void report_filling(const std::string& node, const FilledHoles& filled, Report& report) {
  report.lines.push_back(
      fmt::format("\"{}\": {}{} holes closed with {} triangles of area {:.4g} and {} texels; colours at the border "
                  "differ by {:.1f} of "
                  "255 (root mean square) from those that continue",
                  node, filled.removed > 0 ? fmt::format("{} triangles removed; ", filled.removed) : "", filled.holes,
                  filled.triangles, filled.area, filled.texels, 255 * filled.color_step));
  if (filled.open_edges > 0)
    report.lines.push_back(
        fmt::format("note: {} edges of the border form no closed loop and stay open", filled.open_edges));
  if (filled.unfilled > 0)
    report.lines.push_back(
        fmt::format("note: {} holes stay open: their borders cross themselves, or are too long", filled.unfilled));
}

void set_filled(Node& node, const FilledHoles& filled) {
  for (auto& [stored, saved] : node.saved_selections) {
    TriangleSet longer = *saved;
    longer.resize(filled.object->triangle_count(), 0);
    saved = std::make_shared<const TriangleSet>(std::move(longer));
  }
  node.object = filled.object;
  node.selection = nullptr;
}

}  // namespace rebake
