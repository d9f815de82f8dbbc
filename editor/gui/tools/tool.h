#pragma once

#include <imgui.h>

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "editor/gui/platform/window.h"
#include "editor/gui/state/tool_context.h"
#include "editor/gui/ui/style.h"
#include "editor/gui/view/viewport_projection.h"

namespace rebake {

/// State of the mouse over the viewport in one frame. Positions are in viewport pixels (x right, y down).
struct Pointer {
  Vec2 at{0, 0};
  std::vector<Vec2> way;                                 ///< positions that it passed since the last frame, in order
  bool inside = false;                                   ///< over the viewport, and no window or popup covers it
  bool pressed = false, down = false, released = false;  ///< left button: pressed this frame, held, released this frame
  bool double_clicked = false;                           ///< left button, this frame
  bool cancelled_drag = false;                           ///< the right button cancelled the tool's drag this frame
  bool shift = false, control = false, alt = false;
};

/// Recognises clicks of the left button, as opposed to drags. Call ends() in every frame.
class Click {
 public:
  /// Whether a click that began inside the viewport ends in this frame, at most 4 pixels from where it began.
  bool ends(const Pointer& pointer) {
    constexpr double reach = 4;
    if (pointer.pressed && pointer.inside) pressed_at_ = pointer.at;
    if (!pointer.released || !pressed_at_) return false;
    return (*std::exchange(pressed_at_, std::nullopt) - pointer.at).norm() <= reach;
  }

 private:
  std::optional<Vec2> pressed_at_;
};

/// Base class of the viewport's tools, which handle the left mouse button. A drag shows a preview; its release makes
/// one edit.
class ViewTool {
 public:
  virtual ~ViewTool() = default;
  /// Handles the pointer in one frame.
  virtual void pointer(ToolContext& editor, const ViewportProjection& lens, const Pointer& pointer) = 0;
  /// Draws 2D handles over the viewport, whose top left corner is at `origin` (window pixels).
  virtual void draw(const ToolContext& editor, const ViewportProjection& lens, const Pointer& pointer, ImDrawList& list,
                    const ImVec2& origin) const = 0;
  /// Adds lines and triangles in world space.
  virtual void add_guides(const ToolContext& /*editor*/, Guides& /*guides*/) const {}
  /// Handles a key press before commands see it; returns true if the tool used it.
  virtual bool key(ToolContext& /*editor*/, const KeyPress& /*press*/) { return false; }
  /// Draws the tool's options and help into the tool bar.
  virtual void options(ToolContext& editor) = 0;
  /// Whether pointer() needs the current scene. If so, it is not called while the worker is busy, except during a drag.
  virtual bool needs_current_scene() const { return true; }
  /// Whether a press with Alt at this pixel is for the tool; otherwise it orbits the view.
  virtual bool handles_alt_press(const ToolContext& /*editor*/, const ViewportProjection& /*lens*/,
                                 const Vec2& /*at*/) const {
    return false;
  }
  /// Whether a drag or an unfinished shape is in progress, which Escape cancels.
  virtual bool busy() const { return false; }
  /// Cancels the drag or shape in progress; without one, resets the tool. Edits stay.
  virtual void cancel(ToolContext& editor) = 0;
  /// Called when another tool becomes active. Edits stay.
  virtual void leave(ToolContext& editor) { cancel(editor); }
};

/// All tools by kind; the table is in tools.cpp. Tools own no GPU objects.
using Tools = std::map<ToolKind, std::unique_ptr<ViewTool>>;
Tools make_tools();

/// A button of the tool bar. Its name, key and help are those of the command that activates the tool.
struct ToolButton {
  const char* icon;     ///< character of the icon font
  const char* command;  ///< title in command_table
  ToolKind kind;
  bool begins_group = false;  ///< separated from the button before it
};
std::span<const ToolButton> tool_buttons();

/// Window position of a viewport pixel; `origin` is the viewport's top left corner.
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

/// Draws a line of text on a dark background, readable over any image.
inline void draw_label(ImDrawList& list, const ImVec2& at, const std::string& text) {
  if (text.empty()) return;
  list.AddRectFilled({at.x - px(7), at.y - px(4)},
                     {at.x + ImGui::CalcTextSize(text.c_str()).x + px(7), at.y + ImGui::GetFontSize() + px(4)},
                     IM_COL32(0, 0, 0, 190), px(4));
  list.AddText(at, IM_COL32(255, 255, 255, 255), text.c_str());
}

/// How a new selection combines with the existing one: Shift adds, Ctrl removes, both intersect, none replaces it.
inline SelectMode select_mode(const Pointer& pointer) {
  if (pointer.shift && pointer.control) return SelectMode::intersect;
  return pointer.shift ? SelectMode::add : pointer.control ? SelectMode::remove : SelectMode::set;
}

}  // namespace rebake
