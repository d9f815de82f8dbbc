#include "editor/gui/tools/bend_tool.h"
#include "editor/gui/tools/cage_tool.h"
#include "editor/gui/tools/gizmo.h"
#include "editor/gui/tools/pick_tool.h"
#include "editor/gui/tools/region_tool.h"

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
  tools[ToolKind::cage] = std::make_unique<CageTool>();
  return tools;
}

}  // namespace rebake
