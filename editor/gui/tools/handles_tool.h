#pragma once

#include "editor/edits/deform/handles.h"
#include "editor/gui/tools/tool.h"

namespace rebake {

/// Points on the surface that are held or pulled, with what lies between as rigid as possible. Every release is a
/// step of the document's history: the first an edit, each later one a revision of it (Document::revise).
class HandlesTool final : public ViewTool {
 public:
  void pointer(Desk& desk, const Lens& lens, const Pointer& pointer) override;
  void draw(const Desk& desk, const Lens& lens, const Pointer& pointer, ImDrawList& list,
            const ImVec2& origin) const override;
  bool key(Desk& desk, const KeyPress& press) override;
  void options(Desk& desk) override;
  bool busy() const override { return held_ >= 0; }
  void cancel(Desk& desk) override;
  void leave(Desk& desk) override;

 private:
  struct Pin {
    Vec3 at;     ///< on the surface, as it was
    Vec3 moved;  ///< where it is pulled to
    bool holds;  ///< it stays where it is
    Vec3 motion() const { return moved - at; }
  };
  using Pins = std::vector<Pin>;
  std::optional<HandlesDeform> edit_for(const Pins& pins) const;
  void begin(Desk& desk);
  void add(Desk& desk, const Lens& lens, const Vec2& at, bool holds);
  void follow(Desk& desk);
  void show(Desk& desk);
  void commit(Desk& desk);
  void take_away(Desk& desk, std::size_t pin);
  void end();
  bool shown() const { return from_ && !asleep_; }
  int pin_at(const Lens& lens, const Vec2& at) const;

  bool holds_ = true;  ///< what a click makes
  float coarseness_ = 0.08F;
  Pins pins_, before_;         ///< now, and when the drag began
  std::vector<Pins> steps_;    ///< at rest, and after each release
  std::size_t at_ = 0;         ///< which of them the document holds
  std::optional<Scene> from_;  ///< that the pins were set in; the edit is made of it
  DeformTarget target_;
  bool asleep_ = false;  ///< the document holds none of the pins' steps now; redo may return to them
  double reach_ = 0;     ///< radius around a pin within which the cage goes with it
  int held_ = -1;
  Vec2 pressed_at_{0, 0};
};

}  // namespace rebake
