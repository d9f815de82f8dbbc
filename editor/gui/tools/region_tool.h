#pragma once

#include "editor/gui/tools/tool.h"

namespace rebake {

/// Selects triangles, or erases texels, in a region of the viewport: a rectangle, lasso, polygon or brush stroke.
class RegionTool final : public ViewTool {
 public:
  explicit RegionTool(ToolKind kind) : kind_(kind) {}
  void pointer(ToolContext& editor, const ViewportProjection& lens, const Pointer& pointer) override;
  void draw(const ToolContext& editor, const ViewportProjection& lens, const Pointer& pointer, ImDrawList& list,
            const ImVec2& origin) const override;
  bool key(ToolContext& editor, const KeyPress& press) override;
  void options(ToolContext& editor) override;
  bool needs_current_scene() const override { return false; }
  bool busy() const override { return !points_.empty(); }
  void cancel(ToolContext& editor) override;

 private:
  bool paints() const { return kind_ == ToolKind::brush || kind_ == ToolKind::erase; }
  /// Makes the edit from the points.
  void finish(ToolContext& editor);

  ToolKind kind_;
  std::vector<Vec2> points_;           ///< viewport pixels: two corners of the rectangle, or the line drawn so far
  SelectMode mode_ = SelectMode::set;  ///< from the modifier keys at the start
};

}  // namespace rebake
