#pragma once

#include "editor/gui/tools/tool.h"

namespace rebake {

/// Measures the distance of two clicked surface points, and scales the scene so that it becomes a known length.
class MeasureTool final : public ViewTool {
 public:
  void pointer(ToolContext& editor, const ViewportProjection& lens, const Pointer& pointer) override;
  void draw(const ToolContext& editor, const ViewportProjection& lens, const Pointer& pointer, ImDrawList& list,
            const ImVec2& origin) const override;
  void options(ToolContext& editor) override;
  void cancel(ToolContext& editor) override;

 private:
  void add(const ToolContext& editor, const Vec3& point);
  /// Forgets the points if the scene has changed since they were clicked.
  void forget_stale(const ToolContext& editor);

  std::vector<NodePtr> roots_;  ///< scene of the points
  std::vector<Vec3> points_;    ///< clicked, at most two; world space
  Click click_;
  double length_ = 0;  ///< distance of the two points, as edited in the field
};

}  // namespace rebake
