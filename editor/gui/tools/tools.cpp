#include "editor/gui/tools/bend_tool.h"
#include "editor/gui/tools/cage_tool.h"
#include "editor/gui/tools/gizmo.h"
#include "editor/gui/tools/ground_tool.h"
#include "editor/gui/tools/handles_tool.h"
#include "editor/gui/tools/measure_tool.h"
#include "editor/gui/tools/pick_tool.h"
#include "editor/gui/tools/region_tool.h"
#include "editor/gui/tools/register_tool.h"
#include "editor/gui/tools/volume_tool.h"
#include "editor/gui/ui/icons.h"

namespace rebake {

Tools make_tools() {
  Tools tools;
  tools[ToolKind::pick] = std::make_unique<PickTool>(false);
  tools[ToolKind::flood] = std::make_unique<PickTool>(true);
  for (const ToolKind kind :
       {ToolKind::rectangle, ToolKind::lasso, ToolKind::polygon, ToolKind::brush, ToolKind::erase})
    tools[kind] = std::make_unique<RegionTool>(kind);
  for (const ToolKind kind : {ToolKind::move, ToolKind::rotate, ToolKind::scale})
    tools[kind] = std::make_unique<Gizmo>(kind);
  tools[ToolKind::volume] = std::make_unique<VolumeTool>();
  tools[ToolKind::bend] = std::make_unique<BendTool>();
  tools[ToolKind::handles] = std::make_unique<HandlesTool>();
  tools[ToolKind::cage] = std::make_unique<CageTool>();
  tools[ToolKind::ground] = std::make_unique<GroundTool>();
  tools[ToolKind::measure] = std::make_unique<MeasureTool>();
  tools[ToolKind::register_captures] = std::make_unique<RegisterTool>();
  return tools;
}

std::span<const ToolButton> tool_buttons() {
  static constexpr ToolButton buttons[] = {
      {icons::cursor_default, "Pick nodes", ToolKind::pick},
      {icons::selection, "Rectangle", ToolKind::rectangle, true},
      {"", "Lasso", ToolKind::lasso},
      {icons::vector_polygon, "Polygon", ToolKind::polygon},
      {icons::brush, "Brush", ToolKind::brush},
      {icons::format_color_fill, "Flood", ToolKind::flood},
      {icons::package_variant, "Volume", ToolKind::volume},
      {icons::eraser, "Eraser", ToolKind::erase, true},
      {icons::cursor_move, "Move", ToolKind::move, true},
      {icons::rotate_3d, "Rotate", ToolKind::rotate},
      {icons::arrow_expand_all, "Scale", ToolKind::scale},
      {icons::cube_unfolded, "Cage", ToolKind::cage, true},
      {icons::vector_curve, "Bend, twist, taper", ToolKind::bend},
      {icons::pin, "Handles", ToolKind::handles},
      {icons::grid, "Ground", ToolKind::ground, true},
      {icons::ruler, "Measure", ToolKind::measure},
      {icons::vector_point, "Register", ToolKind::register_captures},
  };
  return buttons;
}

}  // namespace rebake
