#pragma once

#include "editor/gui/tools/tool.h"

namespace rebake {

/// Selects (or erases) in a region of the picture: rectangle, lasso, polygon, brush.
class RegionTool final : public ViewTool {
 public:
  explicit RegionTool(ToolKind kind) : kind_(kind) {}
  void pointer(Desk& desk, const Lens& lens, const Pointer& pointer) override;
  void draw(const Desk& desk, const Lens& lens, const Pointer& pointer, ImDrawList& list,
            const ImVec2& origin) const override;
  bool key(Desk& desk, const KeyPress& press) override;
  void options(Desk& desk) override;
  bool wants_scene() const override { return false; }
  bool busy() const override { return !points_.empty(); }
  void cancel(Desk& desk) override;

 private:
  bool paints() const { return kind_ == ToolKind::brush || kind_ == ToolKind::erase; }
  void finish(Desk& desk);

  ToolKind kind_;
  std::vector<Vec2> points_;
  SelectMode mode_ = SelectMode::set;  ///< by the modifiers when it began
};

}  // namespace rebake
