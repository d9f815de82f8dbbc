#pragma once

#include "editor/gui/tools/tool.h"

namespace rebake {

/// Picks the clicked node; in flood mode, selects triangles of a colour similar to the clicked one.
class PickTool final : public ViewTool {
 public:
  explicit PickTool(bool floods) : floods_(floods) {}
  void pointer(ToolContext& editor, const ViewportProjection& lens, const Pointer& pointer) override;
  void draw(const ToolContext&, const ViewportProjection&, const Pointer&, ImDrawList&, const ImVec2&) const override {}
  bool needs_current_scene() const override { return false; }
  void options(ToolContext& editor) override;
  void cancel(ToolContext&) override {}

 private:
  bool floods_;
  Click click_;
};

}  // namespace rebake
