#pragma once

#include "editor/gui/tools/tool.h"
#include "editor/gui/tools/typed_number.h"

namespace rebake {

/// Bends, twists, tapers or stretches along an axis by dragging its far end; its limits can be dragged too.
class BendTool final : public ViewTool {
 public:
  void pointer(Desk& desk, const Lens& lens, const Pointer& pointer) override;
  void draw(const Desk& desk, const Lens& lens, const Pointer& pointer, ImDrawList& list,
            const ImVec2& origin) const override;
  void add_guides(const Desk& desk, std::vector<Guides::Line>& lines) const override;
  bool key(Desk& desk, const KeyPress& press) override;
  void options(Desk& desk) override;
  bool busy() const override { return held_ != Handle::none; }
  void cancel(Desk& desk) override;

 private:
  enum class Handle { none, from, to, tip };
  /// The axis through what is deformed: from `foot` along `along`, `length` long.
  struct Spine {
    DeformTarget target;
    Vec3 foot, along;
    double length;
    Vec3 at(double share) const { return foot + share * length * along; }
    Vec3 tip() const { return at(1.15); }  ///< beyond the upper limit, so that both can be taken
  };
  std::optional<Spine> spine(const Desk& desk) const;
  Vec3 place(const Spine& spine, Handle handle) const;
  Handle handle_at(const Spine& spine, const Lens& lens, const Vec2& at) const;
  std::optional<Edit> edit(const Lens& lens) const;
  static std::string readout(const Edit& edit);

  enum class Kind { bend, twist, taper, stretch };
  Kind kind_ = Kind::bend;
  int axis_ = 0;              ///< up, of selected triangles the longest; or 1 to 3 for X, Y, Z
  double from_ = 0, to_ = 1;  ///< limits, as shares of the spine
  double falloff_ = 0;        ///< scene units
  Handle held_ = Handle::none;
  std::optional<Spine> bent_;  ///< as it was when the drag began
  Vec2 began_{0, 0}, now_{0, 0};
  TypedNumber typed_;
  std::string typed_text_, readout_;  ///< as they were with the last preview
};

}  // namespace rebake
