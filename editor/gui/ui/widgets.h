#pragma once

#include <imgui.h>

#include <string>

#include "editor/gui/ui/style.h"

namespace rebake::ui {

// Widgets of panels, tools and dialogs. Buttons, toggles, choices and sections announce themselves by their label
// (announce.h); for a label with "##", by the part after it.

/// Tooltip of the last item: a title, its key in grey, and a sentence below. Empty strings are omitted.
void tip(const std::string& title, const std::string& key = "", const std::string& sentence = "");

/// Buttons return true when clicked.
bool button(const char* label, const ImVec2& size = {0, 0});
/// The default button of a dialog, in the accent colour.
bool primary_button(const char* label, const ImVec2& size = {0, 0});
/// A square button with an icon. `name` is announced; without an icon font the button shows the start of `name`.
bool icon_button(const char* icon, const char* name, bool chosen = false);
/// A small button with an icon and no background unless hovered, as high as a line of text. `on_accent`: it lies on a
/// selected row.
bool quiet_icon(const char* icon, const char* name, bool chosen = false, bool on_accent = false);
/// A check box; true if `value` changed.
bool toggle(const char* label, bool& value);
/// Radio buttons side by side; `value` is an index into `names`. True if it changed.
bool choice(const char* label, int& value, std::initializer_list<const char*> names);

/// A label to the left of the next widget, which fills the rest of the line.
void label(const char* text);
/// A collapsible section header: a click toggles `open`. Returns `open`.
bool section(const char* title, bool& open);
/// Secondary text, wrapped at the panel's width.
void muted(const std::string& text);
/// Text wrapped at the panel's width.
void wrapped(const std::string& text, Rgb color);
/// Places the next item, of about this width in pixels, beside the last one if there is room, else on a new line.
void flow(float width);
/// A grey hint beside the last item, shortened to the available width; the tooltip shows the full text.
void hint(const std::string& text);
/// The text, cut off with an ellipsis if it is wider than `width` pixels.
std::string shortened(const std::string& text, float width);

}  // namespace rebake::ui
