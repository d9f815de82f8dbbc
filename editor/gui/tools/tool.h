#pragma once

#include <imgui.h>

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "editor/gui/ui/style.h"
#include "editor/gui/view/lens.h"
#include "editor/gui/window/desk.h"
#include "editor/gui/window/window.h"

namespace rebake {

/// The pointer over the viewport, in its pixels.
struct Pointer {
  Vec2 at{0, 0};
  std::vector<Vec2> way;                                 ///< where it was since the last frame, up to `at`
  bool inside = false;                                   ///< over the viewport, nothing above it
  bool pressed = false, down = false, released = false;  ///< left button: just now, held, just now
  bool double_clicked = false;
  bool let_go = false;  ///< right button, just now
  bool shift = false, control = false, alt = false;
};

/// Tells clicks from drags.
class Click {
 public:
  /// Whether a click inside the viewport ends in this frame: the pointer moved by at most 4 pixels since the press.
  bool ends(const Pointer& pointer) {
    constexpr double reach = 4;
    if (pointer.pressed && pointer.inside) pressed_at_ = pointer.at;
    if (!pointer.released || !pressed_at_) return false;
    return (*std::exchange(pressed_at_, std::nullopt) - pointer.at).norm() <= reach;
  }

 private:
  std::optional<Vec2> pressed_at_;
};

/// What the left button does in the viewport. A drag is a preview; release makes one edit.
class ViewTool {
 public:
  virtual ~ViewTool() = default;
  virtual void pointer(Desk& desk, const Lens& lens, const Pointer& pointer) = 0;
  /// Draws over the picture, whose top left corner is at `origin`.
  virtual void draw(const Desk& desk, const Lens& lens, const Pointer& pointer, ImDrawList& list,
                    const ImVec2& origin) const = 0;
  /// Lines and triangles in the world.
  virtual void add_guides(const Desk& /*desk*/, Guides& /*guides*/) const {}
  /// Takes a key before commands do; true when it was for this tool.
  virtual bool key(Desk& /*desk*/, const KeyPress& /*press*/) { return false; }
  /// Options and help, in the tool bar's panel.
  virtual void options(Desk& desk) = 0;
  /// Whether it wants the scene as it is now: it waits for what is being done.
  virtual bool wants_scene() const { return true; }
  /// Whether a press there with Alt held is for the tool; else it turns the view.
  virtual bool takes_alt(const Desk& /*desk*/, const Lens& /*lens*/, const Vec2& /*at*/) const { return false; }
  /// True while something is held that Escape would let go of.
  virtual bool busy() const { return false; }
  virtual void cancel(Desk& desk) = 0;
  /// Another tool is taken: what was done stays.
  virtual void leave(Desk& desk) { cancel(desk); }
};

/// All of them, as tools.cpp lists them. They hold nothing of the GPU.
using Tools = std::map<ToolKind, std::unique_ptr<ViewTool>>;
Tools make_tools();

/// How a tool is shown in the tool bar. Its name, key and help are those of the command that takes it.
struct ToolButton {
  const char* icon;
  const char* command;
  ToolKind kind;
  bool begins_group = false;
};
std::span<const ToolButton> tool_buttons();

inline ImVec2 on_screen(const Vec2& pixel, const ImVec2& origin) {
  return {origin.x + static_cast<float>(pixel.x()), origin.y + static_cast<float>(pixel.y())};
}

/// Whether a pixel lies in a polygon, by the even-odd rule.
inline bool inside_polygon(const std::vector<Vec2>& corners, const Vec2& p) {
  bool inside = false;
  for (std::size_t i = 0, j = corners.size() - 1; i < corners.size(); j = i++)
    if ((corners[i].y() > p.y()) != (corners[j].y() > p.y()) &&
        p.x() - corners[i].x() <
            (corners[j].x() - corners[i].x()) * (p.y() - corners[i].y()) / (corners[j].y() - corners[i].y()))
      inside = !inside;
  return inside;
}

/// A line of text that can be read over any picture.
inline void draw_label(ImDrawList& list, const ImVec2& at, const std::string& text) {
  if (text.empty()) return;
  list.AddRectFilled({at.x - px(7), at.y - px(4)},
                     {at.x + ImGui::CalcTextSize(text.c_str()).x + px(7), at.y + ImGui::GetFontSize() + px(4)},
                     IM_COL32(0, 0, 0, 190), px(4));
  list.AddText(at, IM_COL32(255, 255, 255, 255), text.c_str());
}

/// How modifiers join a new selection to the present one.
inline SelectMode select_mode(const Pointer& pointer) {
  if (pointer.shift && pointer.control) return SelectMode::intersect;
  return pointer.shift ? SelectMode::add : pointer.control ? SelectMode::remove : SelectMode::set;
}

}  // namespace rebake
