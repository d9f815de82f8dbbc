#pragma once

#include "editor/gui/tools/tool.h"
#include "editor/gui/tools/typed_number.h"

namespace rebake {

/// Transform gizmo: translates, rotates or scales the selected triangles of the picked nodes, or the nodes themselves,
/// by handles along axes.
class Gizmo final : public ViewTool {
 public:
  explicit Gizmo(ToolKind kind) : kind_(kind) {}
  void pointer(ToolContext& editor, const ViewportProjection& lens, const Pointer& pointer) override;
  void draw(const ToolContext& editor, const ViewportProjection& lens, const Pointer& pointer, ImDrawList& list,
            const ImVec2& origin) const override;
  bool key(ToolContext& editor, const KeyPress& press) override;
  void options(ToolContext& editor) override;
  bool busy() const override { return held_ != none; }
  bool handles_alt_press(const ToolContext& editor, const ViewportProjection& lens, const Vec2& at) const override;
  void cancel(ToolContext& editor) override;

 private:
  /// Handles: 0, 1, 2 are axes; plane + k is the plane normal to axis k. `all` moves in the view plane, rotates about
  /// the view direction, or scales uniformly.
  static constexpr int none = -1, all = 3, plane = 4;
  /// Nodes to transform, and the gizmo's frame in world space.
  struct Target {
    std::vector<NodeId> nodes;
    bool triangles = false;          ///< only the nodes' selected triangles
    Vec3 pivot{0, 0, 0};             ///< centre of the box
    Vec3 foot{0, 0, 0};              ///< centre of the box's underside
    Mat3 axes = Mat3::Identity();    ///< columns: unit axes of the handles
    Mat3 local = Mat3::Identity();   ///< columns: unit axes of the first node
    Vec3 direction_to_eye{0, 0, 1};  ///< unit view direction, axis of the outer ring
    Vec3 axis(int handle) const { return handle == all ? direction_to_eye : Vec3(axes.col(handle)); }
  };
  /// The current target; nothing without picked nodes or selected triangles.
  std::optional<Target> target(const ToolContext& editor, const ViewportProjection& lens) const;
  /// Starts a drag of a handle at a viewport pixel.
  void begin(const Target& target, int handle, const Vec2& at);
  /// Ends the drag, and returns to the previous tool if a key began it.
  void end(ToolContext& editor);
  /// Handles an axis key during a drag, as Blender does: constrains it to the world axis, then the local axis, then not
  /// at all. `across`: to the plane normal to the axis.
  void constrain(int axis, bool across);
  /// Length of the handles in scene units; constant in pixels.
  static double reach(const ViewportProjection& lens, const Vec3& pivot);
  /// The handle at a viewport pixel, or `none`.
  int handle_at(const Target& target, const ViewportProjection& lens, const Vec2& at) const;
  /// Amount of the drag: scene units, degrees, or scale factor − 1. For a free move, the share of the pointer's motion.
  double amount(const ViewportProjection& lens, const Pointer& pointer) const;
  /// Corners of a plane's handle in viewport pixels; empty if the plane is seen edge-on.
  std::vector<Vec2> plane_handle(const Target& target, const ViewportProjection& lens, int axis) const;
  /// World-space motion of a drag in a plane.
  Vec3 motion_in_plane(const ViewportProjection& lens, bool orthographic, const Pointer& pointer) const;
  /// One edit per node for the current drag.
  std::vector<Edit> edits(const ViewportProjection& lens) const;
  bool moves_in_plane() const { return held_ >= plane; }
  /// World position under a viewport pixel: on nodes that are not dragged, otherwise on the ground plane.
  std::optional<Vec3> surface(const ToolContext& editor, const ViewportProjection& lens, const Vec2& at) const;
  static void preview(ToolContext& editor, const std::vector<Edit>& made);

  ToolKind kind_;
  int held_ = none;                 ///< dragged handle
  bool copies_ = false;             ///< the drag makes copies of the nodes
  bool by_key_ = false;             ///< a key began the drag; a click or Enter ends it
  Target at_;                       ///< target at the start of the drag
  Vec2 from_{0, 0}, now_{0, 0};     ///< pointer at the start of the drag and now, viewport pixels
  double amount_ = 0;               ///< of the drag, see amount()
  Vec3 in_plane_{0, 0, 0};          ///< motion of a drag in a plane, world space
  Camera camera_;                   ///< camera for which amount_ was computed
  Vec3 foot_{0, 0, 0};              ///< Target::foot at the start of the drag
  std::optional<Vec3> snap_point_;  ///< surface point that foot_ snaps to
  TypedNumber typed_;
  int axis_presses_ = 0;      ///< presses of the constrained axis's key, modulo 3
  bool constrained_ = false;  ///< the constraint has changed since the last preview
  bool entered_ = false;      ///< Enter was pressed during a drag that a key began
};

}  // namespace rebake
