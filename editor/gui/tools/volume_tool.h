#pragma once

#include "editor/gui/tools/tool.h"

namespace rebake {

/// Selects the triangles in a box or sphere, which is moved by a handle at its centre and resized by handles on its
/// sides.
class VolumeTool final : public ViewTool {
 public:
  void pointer(ToolContext& editor, const ViewportProjection& lens, const Pointer& pointer) override;
  void draw(const ToolContext& editor, const ViewportProjection& lens, const Pointer& pointer, ImDrawList& list,
            const ImVec2& origin) const override;
  void add_guides(const ToolContext& editor, Guides& guides) const override;
  bool key(ToolContext& editor, const KeyPress& press) override;
  void options(ToolContext& editor) override;
  bool needs_current_scene() const override { return false; }
  bool busy() const override { return held_ != none; }
  void cancel(ToolContext& editor) override;

 private:
  static constexpr int none = -1, middle = 6;  ///< handles; 0 … 5 are the sides +x, −x, +y, −y, +z, −z
  struct Volume {
    Vec3 center{0, 0, 0}, half{0, 0, 0};  ///< world space; half extents of zero: not placed yet
  };
  /// Centres the volume on the picked nodes, or on the scene, at half the size of their box.
  void place(const ToolContext& editor);
  /// World position of a handle.
  Vec3 handle(int number) const;
  /// The handle nearest to a viewport pixel, or `none` out of reach.
  int handle_at(const ViewportProjection& lens, const Vec2& at) const;
  void select(ToolContext& editor, SelectMode mode) const;

  bool sphere_ = false;
  Volume volume_, before_;  ///< current volume, and that at the start of the drag
  int held_ = none;         ///< dragged handle
  Vec2 from_{0, 0};         ///< viewport pixel where the drag began
};

}  // namespace rebake
