#pragma once

#include "editor/gui/tools/tool.h"
#include "editor/gui/tools/typed_number.h"

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
  bool busy() const override { return held_ != none; }
  bool takes_alt(const Desk& desk, const Lens& lens, const Vec2& at) const override;
  void cancel(Desk& desk) override;

 private:
  static constexpr int none = -1, all = 3, plane = 4;  ///< plane + k: the plane across axis k
  struct Target {
    std::vector<NodeId> nodes;
    bool triangles = false;  ///< selected ones, not the nodes
    Vec3 pivot{0, 0, 0};
    Vec3 foot{0, 0, 0};             ///< middle of its underside
    Mat3 axes = Mat3::Identity();   ///< columns
    Mat3 local = Mat3::Identity();  ///< those of the first node
    Vec3 towards_eye{0, 0, 1};      ///< the axis of the outer ring
    Vec3 axis(int handle) const { return handle == all ? towards_eye : Vec3(axes.col(handle)); }
  };
  std::optional<Target> target(const Desk& desk, const Lens& lens) const;
  void begin(const Target& target, int handle, const Vec2& at);
  void end(Desk& desk);
  /// Keys of axes during a drag: along one, along its local one, free again.
  /// `across`: in the plane that it is normal to.
  void constrain(int axis, bool across);
  /// Length of the handles in scene units, the same on the screen everywhere.
  static double reach(const Lens& lens, const Vec3& pivot);
  /// 0 to 2 an axis, `all` of them (the view's plane, about the line of sight, or all sizes), a plane, or `none`.
  int handle_at(const Target& target, const Lens& lens, const Vec2& at) const;
  /// What the drag comes to: units, degrees, or a factor less 1.
  double amount(const Lens& lens, const Pointer& pointer) const;
  /// Its corners on the screen; empty where it is seen edge on.
  std::vector<Vec2> plane_handle(const Target& target, const Lens& lens, int axis) const;
  /// How far a drag in a plane goes.
  Vec3 motion_in_plane(const Lens& lens, bool orthographic, const Pointer& pointer) const;
  std::vector<Edit> edits(const Lens& lens) const;
  bool moves_in_plane() const { return held_ >= plane; }
  /// Where the surface under the pointer is, of nodes that are not moved.
  std::optional<Vec3> surface(const Desk& desk, const Lens& lens, const Vec2& at) const;
  static void preview(Desk& desk, const std::vector<Edit>& made);

  ToolKind kind_;
  int held_ = none;
  bool copies_ = false;  ///< what is dragged is a copy
  bool by_key_ = false;  ///< begun by a key: a click ends it, no button is held
  Target at_;            ///< as it was when the drag began
  Vec2 from_{0, 0}, now_{0, 0};
  double amount_ = 0;
  Vec3 in_plane_{0, 0, 0};    ///< motion of a drag in a plane
  Camera camera_;             ///< that amount_ was worked out with
  Vec3 foot_{0, 0, 0};        ///< middle of the underside of what is moved
  std::optional<Vec3> onto_;  ///< the surface that it is put onto
  TypedNumber typed_;
  int axis_presses_ = 0;      ///< of the key of the axis that is held
  bool constrained_ = false;  ///< another axis was taken since the last preview
  bool entered_ = false;      ///< Enter was typed during a drag begun by a key
};

}  // namespace rebake
