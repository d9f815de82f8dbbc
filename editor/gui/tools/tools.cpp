#include "editor/gui/tools/bend_tool.h"
#include "editor/gui/tools/cage_tool.h"
#include "editor/gui/tools/gizmo.h"
#include "editor/gui/tools/handles_tool.h"
#include "editor/gui/tools/pick_tool.h"
#include "editor/gui/tools/region_tool.h"
#include "editor/gui/ui/icons.h"

namespace rebake {

Tools make_tools() {
  Tools tools;
  tools[ToolKind::pick] = std::make_unique<PickTool>(false);
  tools[ToolKind::flood] = std::make_unique<PickTool>(true);
  for (const ToolKind kind :
       {ToolKind::rectangle, ToolKind::lasso, ToolKind::polygon, ToolKind::brush, ToolKind::erase})
    tools[kind] = std::make_unique<RegionTool>(kind);
  for (const ToolKind kind : {ToolKind::move, ToolKind::turn, ToolKind::scale})
    tools[kind] = std::make_unique<Gizmo>(kind);
  tools[ToolKind::bend] = std::make_unique<BendTool>();
  tools[ToolKind::handles] = std::make_unique<HandlesTool>();
  tools[ToolKind::cage] = std::make_unique<CageTool>();
  return tools;
}

std::span<const ToolButton> tool_buttons() {
  static constexpr ToolButton buttons[] = {
      {ToolKind::pick, icons::cursor_default, "Pick nodes"},
      {ToolKind::rectangle, icons::selection, "Rectangle", true},
      {ToolKind::lasso, "", "Lasso"},
      {ToolKind::polygon, icons::vector_polygon, "Polygon"},
      {ToolKind::brush, icons::brush, "Brush"},
      {ToolKind::flood, icons::format_color_fill, "Flood"},
      {ToolKind::erase, icons::eraser, "Eraser", true},
      {ToolKind::move, icons::cursor_move, "Move", true},
      {ToolKind::turn, icons::rotate_3d, "Turn"},
      {ToolKind::scale, icons::arrow_expand_all, "Scale"},
      {ToolKind::cage, icons::cube_unfolded, "Cage", true},
      {ToolKind::bend, icons::vector_curve, "Bend, twist, taper"},
      {ToolKind::handles, icons::pin, "Handles"},
  };
  return buttons;
}

}  // namespace rebake
