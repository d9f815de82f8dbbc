#include "editor/gui/ui/number_field.h"

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_internal.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/expression.h"
#include "editor/gui/ui/style.h"

namespace rebake::ui {

namespace {

// State of the one field that is typed in or dragged. For the window's thread only.
struct Editing {
  ImGuiID typed = 0;         ///< the field with an open text box; 0: none
  int seen = 0;              ///< number of the last frame that drew the field `typed`
  bool begins = false;       ///< the text box gets the keyboard focus in this frame
  bool next = false;         ///< Tab was pressed: the next field drawn opens its text box
  std::string text, before;  ///< current text, and the text when the box was opened
  ImGuiID dragged = 0;       ///< the field under drag; 0: none
  int drag_seen = 0;         ///< number of the last frame that drew the field `dragged`
  double from = 0;           ///< value at the start of the drag
  bool moved = false, cancelled = false;
};
Editing editing;

// The text up to the first non-ASCII byte: "30°" is edited as "30".
std::string without_unit(const std::string& text) {
  return text.substr(0,
                     std::size_t(std::find_if(text.begin(), text.end(), [](char c) { return c < 0; }) - text.begin()));
}

Changed typed_field(double& value, float width) {
  if (editing.begins) ImGui::SetKeyboardFocusHere();
  ImGui::SetNextItemWidth(width);
  // Dear ImGui's own Tab order only has text boxes, and at most one is open. So Tab is handled here.
  const auto tabbed = [](ImGuiInputTextCallbackData*) {
    editing.next = true;
    return 0;
  };
  ImGui::InputText("##typed", &editing.text, ImGuiInputTextFlags_AutoSelectAll | ImGuiInputTextFlags_CallbackCompletion,
                   tabbed);
  if (std::exchange(editing.begins, false)) return Changed::nothing;
  if (editing.next)
    ImGui::ClearActiveID();
  else if (!ImGui::IsItemDeactivated())
    return Changed::nothing;
  editing.typed = 0;
  if (editing.text == editing.before) return Changed::nothing;
  const std::optional<double> read = evaluated(editing.text);
  if (!read) return Changed::failed;
  if (*read == value) return Changed::nothing;
  value = *read;
  return Changed::finished;
}

// The value with as many significant digits (at most 6) as fit into the width, and its unit.
std::string fitting(const std::string& text, double value, float width) {
  const std::string unit = text.substr(without_unit(text).size());
  const float room = width - 2 * ImGui::GetStyle().FramePadding.x;
  std::string shorter = text;
  for (int digits = 6; digits > 1 && ImGui::CalcTextSize(shorter.c_str()).x > room; --digits)
    shorter = fmt::format("{:.{}g}", value, digits) + unit;
  return shorter;
}

}  // namespace

bool cancel_drag() { return editing.dragged != 0 && (editing.cancelled = true); }

bool takes_text() {
  // A field that is no longer drawn loses its text box.
  if (editing.typed != 0 && ImGui::GetFrameCount() > editing.seen + 1) editing.typed = 0;
  const ImGuiContext& context = *ImGui::GetCurrentContext();
  const bool in_text = context.ActiveId != 0 && context.ActiveId == context.InputTextState.ID;
  return editing.typed != 0 || in_text || context.IO.WantTextInput;
}

Changed number_field(const char* id, double& value, const char* format, double step, float width) {
  ImGui::PushID(id);
  const ImGuiID self = ImGui::GetID("field");
  const std::string text = fmt::format(fmt::runtime(format), value);
  if (std::exchange(editing.next, false) || editing.typed == self) {
    editing.seen = ImGui::GetFrameCount();
    if (editing.typed != self) {
      editing.typed = self;
      editing.begins = true;
      editing.text = editing.before = without_unit(text);
    }
    const Changed changed = typed_field(value, width);
    announce::item(id);
    ImGui::PopID();
    return changed;
  }
  ImGui::PushStyleColor(ImGuiCol_Button, color(theme().field));
  ImGui::PushStyleVar(ImGuiStyleVar_ButtonTextAlign, {0, 0.5F});
  const bool clicked = ImGui::Button((fitting(text, value, width) + "###field").c_str(), {width, 0});
  ImGui::PopStyleVar();
  ImGui::PopStyleColor();
  announce::item(id);
  Changed changed = Changed::nothing;
  if (ImGui::IsItemHovered() || ImGui::IsItemActive()) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
  // A field that was not drawn for a while has lost its drag.
  if (editing.dragged == self && ImGui::GetFrameCount() > editing.drag_seen + 1) editing.dragged = 0;
  if (ImGui::IsItemActivated()) {
    editing.dragged = self;
    editing.from = value;
    editing.moved = editing.cancelled = false;
  }
  if (editing.dragged == self) editing.drag_seen = ImGui::GetFrameCount();
  const float way = ImGui::GetMouseDragDelta(ImGuiMouseButton_Left, 0).x;
  if (editing.dragged == self && std::exchange(editing.cancelled, false)) {
    editing.dragged = 0;
    ImGui::ClearActiveID();
    value = editing.from;
    changed = Changed::cancelled;
  } else if (ImGui::IsItemActive() && editing.dragged == self) {
    editing.moved = editing.moved || std::abs(way) > px(3);
    if (editing.moved) {
      const double fine = ImGui::GetIO().KeyShift ? 0.1 : 1;
      const double wanted = editing.from + fine * step * static_cast<double>(way);
      // Snaps to whole steps, for readable numbers. Shift: ten times finer, without snapping.
      const double rounded = ImGui::GetIO().KeyShift ? wanted : std::round(wanted / step) * step;
      if (rounded != value) {
        value = rounded;
        changed = Changed::dragged;
      }
    }
  } else if (editing.dragged == self) {
    editing.dragged = 0;
    if (editing.moved) {
      changed = Changed::finished;
    } else if (clicked) {
      editing.typed = self;
      editing.seen = ImGui::GetFrameCount();
      editing.begins = true;
      editing.text = editing.before = without_unit(text);
    }
  }
  ImGui::PopID();
  return changed;
}

}  // namespace rebake::ui
