#pragma once

#include <memory>
#include <set>

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
  /// What the last click has picked: a click that was made before it was handled goes on from there.
  std::shared_ptr<std::set<NodeId>> taken_ = std::make_shared<std::set<NodeId>>();
};

}  // namespace rebake
