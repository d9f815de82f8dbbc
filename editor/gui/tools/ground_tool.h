#pragma once

#include "editor/gui/tools/tool.h"

namespace rebake {

/// Sets the scene's ground plane: through three clicked surface points, at a height, at the lowest visible point, or
/// fitted to the selected triangles.
class GroundTool final : public ViewTool {
 public:
  void pointer(ToolContext& editor, const ViewportProjection& lens, const Pointer& pointer) override;
  void draw(const ToolContext& editor, const ViewportProjection& lens, const Pointer& pointer, ImDrawList& list,
            const ImVec2& origin) const override;
  void options(ToolContext& editor) override;
  void cancel(ToolContext& editor) override;

 private:
  /// Adds a clicked point (world space); the third one makes the edit.
  void add(ToolContext& editor, const Vec3& point);

  std::vector<Vec3> points_;    ///< clicked so far, at most two; world space
  std::vector<NodePtr> roots_;  ///< of the scene in which they were clicked
  Click click_;
  double height_ = 0;      ///< value of the height field, scene units
  bool dragging_ = false;  ///< the height field is being dragged
};

}  // namespace rebake
