#pragma once

#include "editor/gui/tool.h"

namespace rebake {

/// Moves, turns or scales the selected triangles of the active nodes, or the nodes themselves, by handles along axes.
class Gizmo final : public ViewTool {
 public:
  explicit Gizmo(ToolKind kind) : kind_(kind) {}
  void pointer(Desk& desk, const Lens& lens, const Pointer& pointer) override;
  void draw(const Desk& desk, const Lens& lens, const Pointer& pointer, ImDrawList& list,
            const ImVec2& origin) const override;
  bool key(Desk& desk, const KeyPress& press) override;
  void options(Desk& desk) override;
  bool busy() const override { return held_ >= 0; }
  void cancel(Desk& desk) override;

 private:
  struct Target {
    std::vector<NodeId> nodes;
    bool triangles = false;  ///< selected ones, not the nodes
    Vec3 pivot{0, 0, 0};
    Mat3 axes = Mat3::Identity();  ///< columns
  };
  std::optional<Target> target(const Desk& desk) const;
  /// Length of the handles in scene units, the same on the screen everywhere.
  static double reach(const Lens& lens, const Vec3& pivot);
  /// 0 to 2 an axis, 3 all of them (the view's plane, or all sizes); −1 none.
  int handle_at(const Target& target, const Lens& lens, const Vec2& at) const;
  /// What the drag comes to: units, degrees, or a factor less 1.
  double amount(const Lens& lens, const Pointer& pointer) const;
  std::vector<Edit> edits(const Lens& lens) const;
  void preview(Desk& desk, const Lens& lens);

  ToolKind kind_;
  int held_ = -1;
  Target at_;  ///< as it was when the drag began
  Vec2 from_{0, 0}, now_{0, 0};
  double amount_ = 0;
  std::string typed_;  ///< numbers typed during the drag
};

}  // namespace rebake
