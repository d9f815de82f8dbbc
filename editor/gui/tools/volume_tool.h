#pragma once

#include "editor/gui/tools/tool.h"

namespace rebake {

/// Selects what lies in a box or a ball that is dragged by its middle and its sides.
class VolumeTool final : public ViewTool {
 public:
  void pointer(Desk& desk, const Lens& lens, const Pointer& pointer) override;
  void draw(const Desk& desk, const Lens& lens, const Pointer& pointer, ImDrawList& list,
            const ImVec2& origin) const override;
  void add_guides(const Desk& desk, Guides& guides) const override;
  bool key(Desk& desk, const KeyPress& press) override;
  void options(Desk& desk) override;
  bool wants_scene() const override { return false; }
  bool busy() const override { return held_ != none; }
  void cancel(Desk& desk) override;

 private:
  static constexpr int none = -1, middle = 6;  ///< 0 to 5: the sides at +x, −x, +y, …
  struct Volume {
    Vec3 center{0, 0, 0}, half{0, 0, 0};  ///< in the world; half of zero: not placed yet
  };
  void place(const Desk& desk);
  Vec3 handle(int number) const;
  int handle_at(const Lens& lens, const Vec2& at) const;
  void select(Desk& desk, SelectMode mode) const;

  bool ball_ = false;
  Volume volume_, before_;  ///< now, and when the drag began
  int held_ = none;
  Vec2 from_{0, 0};
};

}  // namespace rebake
