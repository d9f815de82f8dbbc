#pragma once

#include "editor/gui/tools/falloff_shade.h"
#include "editor/gui/tools/tool.h"
#include "editor/gui/tools/typed_number.h"
#include "mesh_ops/deform/spine.h"

namespace rebake {

/// Bends, twists, tapers or stretches triangles along an axis by dragging a handle at its tip. Two more handles set the
/// limits of the deformed range.
class BendTool final : public ViewTool {
 public:
  void pointer(Desk& desk, const Lens& lens, const Pointer& pointer) override;
  void draw(const Desk& desk, const Lens& lens, const Pointer& pointer, ImDrawList& list,
            const ImVec2& origin) const override;
  void add_guides(const Desk& desk, Guides& guides) const override;
  bool key(Desk& desk, const KeyPress& press) override;
  void options(Desk& desk) override;
  bool busy() const override { return held_ != Handle::none; }
  void cancel(Desk& desk) override;

 private:
  enum class Handle { none, from, to, tip };
  /// The deformed triangles and the axis along them.
  struct Bent {
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
  struct Found {
    int axis = 0;
    bool selection = false;
    std::vector<NodePtr> nodes;
    bool operator==(const Found&) const = default;
  };
  /// The current targets and axis; nothing without a spine.
  std::optional<Bent> bent(const Desk& desk) const;
  /// Searches for the spine again if its inputs have changed.
  void find_spine(Desk& desk);
  /// Whether the document's last edit was made along the current spine.
  bool made_last(const Desk& desk) const;
  /// Inputs of a spine search now.
  Found present(const Desk& desk) const;
  /// World position of a handle before any edit along the spine.
  Vec3 place(const Bent& bent, Handle handle) const;
  /// Position of a point of the spine after the last edits along it.
  static Vec3 shown(const Desk& desk, const Bent& bent, const Vec3& point);
  Handle handle_at(const Desk& desk, const Bent& bent, const Lens& lens, const Vec2& at) const;
  /// One edit per target for the current drag; empty if it changes nothing.
  std::vector<Edit> edits(const Desk& desk, const Lens& lens) const;
  /// Amount of an edit as text, e.g. "Bend 12.5°".
  static std::string readout(const Edit& edit);

  enum class Kind { bend, twist, taper, stretch };
  Kind kind_ = Kind::bend;
  int axis_ = 0;                        ///< 0: along the shape; 1, 2, 3: world X, Y, Z
  bool flipped_ = false;                ///< the fixed end is the spine's far end
  bool curved_ = false;                 ///< deform along the spine's curve
  double from_ = 0, to_ = 1;            ///< limits as shares of the spine's length, 0 … 1
  double falloff_ = 0;                  ///< width of the soft border, scene units
  std::shared_ptr<const Spine> found_;  ///< spine of the targets; null during the search, or if there is none
  Found found_for_;                     ///< inputs of the last search
  Handle held_ = Handle::none;          ///< dragged handle
  std::optional<Bent> held_bent_;       ///< targets and axis at the start of the drag
  Vec2 began_{0, 0}, now_{0, 0};        ///< pointer at the start of the drag and now, viewport pixels
  mutable FalloffShade shade_;
  TypedNumber typed_;
  std::string typed_text_, readout_;  ///< typed text and label of the last preview
};

}  // namespace rebake
