#pragma once

#include "editor/gui/tools/falloff_overlay.h"
#include "editor/gui/tools/tool.h"
#include "editor/gui/tools/typed_number.h"
#include "mesh_ops/deform/bends/spine.h"

namespace rebake {

/// Bends, twists, tapers or stretches triangles along an axis by dragging a handle at its tip. Two more handles set the
/// limits of the deformed range.
class BendTool final : public ViewTool {
 public:
  void pointer(ToolContext& editor, const ViewportProjection& lens, const Pointer& pointer) override;
  void draw(const ToolContext& editor, const ViewportProjection& lens, const Pointer& pointer, ImDrawList& list,
            const ImVec2& origin) const override;
  void add_guides(const ToolContext& editor, Guides& guides) const override;
  bool key(ToolContext& editor, const KeyPress& press) override;
  void options(ToolContext& editor) override;
  bool busy() const override { return held_ != Handle::none; }
  void cancel(ToolContext& editor) override;

 private:
  /// Handles: the limits of the deformed range, and the tip, beyond the far end. The foot, the fixed end, has none.
  enum class Handle { none, from, to, tip };
  /// The deformed triangles and the axis along them.
  struct DeformAxisTarget {
    std::vector<DeformTarget> targets;
    Spine spine;
    bool curved = false;  ///< the axis is the spine's curve, not its straight line
    /// World position at a share of the length, 0 at the foot and 1 at the far end.
    Vec3 at(double share) const;
    double length_to(double share) const;  ///< arc length from the foot, scene units
    Vec3 tip() const { return at(1.15); }  ///< beyond the upper limit, so that both handles can be grabbed
  };
  /// Inputs of a spine search, to detect that they have changed. Owns the nodes, so that a new node never has the
  /// address of an old one.
  struct SpineInputs {
    int axis = 0;
    bool selection = false;
    std::vector<NodePtr> nodes;
    bool operator==(const SpineInputs&) const = default;
  };
  /// The current targets and axis; nothing without a spine.
  std::optional<DeformAxisTarget> current_target(const ToolContext& editor) const;
  /// Searches for the spine again if its inputs have changed.
  void find_spine(ToolContext& editor);
  /// Whether the document's last edit was made along the current spine.
  bool last_edit_follows_spine(const ToolContext& editor) const;
  /// Inputs of a spine search now.
  SpineInputs current_inputs(const ToolContext& editor) const;
  /// World position of a handle before any edit along the spine.
  Vec3 place(const DeformAxisTarget& bent, Handle handle) const;
  /// Position of a point of the spine after the last edits along it.
  static Vec3 shown(const ToolContext& editor, const DeformAxisTarget& bent, const Vec3& point);
  Handle handle_at(const ToolContext& editor, const DeformAxisTarget& bent, const ViewportProjection& lens,
                   const Vec2& at) const;
  /// One edit per target for the current drag; empty if it changes nothing.
  std::vector<Edit> edits(const ToolContext& editor, const ViewportProjection& lens) const;
  /// Amount of an edit as text, e.g. "Bend 12.5°".
  static std::string readout(const Edit& edit);

  enum class Kind { bend, twist, taper, stretch };
  Kind kind_ = Kind::bend;
  int axis_ = 0;                                 ///< 0: along the shape; 1, 2, 3: world X, Y, Z
  bool flipped_ = false;                         ///< the fixed end is the spine's far end
  bool curved_ = false;                          ///< deform along the spine's curve
  double from_ = 0, to_ = 1;                     ///< limits as shares of the spine's length, 0 … 1
  double falloff_ = 0;                           ///< width of the soft border, scene units
  std::shared_ptr<const Spine> found_;           ///< spine of the targets; null during the search, or if there is none
  SpineInputs spine_inputs_;                     ///< inputs of the last search
  Handle held_ = Handle::none;                   ///< dragged handle
  std::optional<DeformAxisTarget> drag_target_;  ///< targets and axis at the start of the drag
  Vec2 began_{0, 0}, now_{0, 0};                 ///< pointer at the start of the drag and now, viewport pixels
  mutable FalloffOverlay falloff_overlay_;
  TypedNumber typed_;
  std::string typed_text_, readout_;  ///< typed text and label of the last preview
};

}  // namespace rebake
