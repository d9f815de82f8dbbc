#pragma once

#include "editor/gui/tools/falloff_shade.h"
#include "editor/gui/tools/tool.h"
#include "editor/gui/tools/typed_number.h"
#include "mesh_ops/deform/spine.h"

namespace rebake {

/// Bends, twists, tapers or stretches along an axis by dragging its far end; its limits can be dragged too.
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
  /// What is bent, and the line along which.
  struct Bent {
    std::vector<DeformTarget> targets;
    Spine spine;
    bool curved = false;  ///< along the spine's curve
    Vec3 at(double share) const;
    double length_to(double share) const;  ///< along it, from its foot
    Vec3 tip() const { return at(1.15); }  ///< beyond the upper limit, so that both can be taken
  };
  /// What a spine was found for. Holds the nodes, so that another one is never taken for them.
  struct Found {
    int axis = 0;
    bool selection = false;
    std::vector<NodePtr> nodes;
    bool operator==(const Found&) const = default;
  };
  std::optional<Bent> bent(const Desk& desk) const;
  void find_spine(Desk& desk);
  bool made_last(const Desk& desk) const;
  Found present(const Desk& desk) const;
  Vec3 place(const Bent& bent, Handle handle) const;
  static Vec3 shown(const Desk& desk, const Bent& bent, const Vec3& point);
  Handle handle_at(const Desk& desk, const Bent& bent, const Lens& lens, const Vec2& at) const;
  std::vector<Edit> edits(const Desk& desk, const Lens& lens) const;
  static std::string readout(const Edit& edit);

  enum class Kind { bend, twist, taper, stretch };
  Kind kind_ = Kind::bend;
  int axis_ = 0;          ///< along the shape; or 1 to 3 for X, Y, Z
  bool flipped_ = false;  ///< held at the other end
  bool curved_ = false;
  double from_ = 0, to_ = 1;            ///< limits, as shares of the spine
  double falloff_ = 0;                  ///< scene units
  std::shared_ptr<const Spine> found_;  ///< of what is to be bent; null while it is looked for, or where there is none
  Found found_for_;
  Handle held_ = Handle::none;
  std::optional<Bent> held_bent_;  ///< as it was when the drag began
  Vec2 began_{0, 0}, now_{0, 0};
  mutable FalloffShade shade_;
  TypedNumber typed_;
  std::string typed_text_, readout_;  ///< as they were with the last preview
};

}  // namespace rebake
