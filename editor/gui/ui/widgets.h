#pragma once

#include <imgui.h>

#include <string>

#include "editor/gui/ui/style.h"

namespace rebake::ui {

// What panels, tools and dialogs are made of. All of them announce themselves by their label (announce.h), which for
// labels with "##" is what follows that.

/// A tooltip of the last item: a title with a key beside it, and a sentence below. Empty parts are left out.
void tip(const std::string& title, const std::string& key = "", const std::string& sentence = "");

bool button(const char* label, const ImVec2& size = {0, 0});
/// The one button of a dialog that does what it is there for.
bool primary_button(const char* label, const ImVec2& size = {0, 0});
/// A square button with a sign; `name` is what it is called, and stands in it where there is no font of signs.
bool icon_button(const char* icon, const char* name, bool chosen = false);
/// The same without a ground until the pointer is over it, as high as a line; `on_accent`: what lies behind it is
/// chosen.
bool quiet_icon(const char* icon, const char* name, bool chosen = false, bool on_accent = false);
/// On or off, as a button with a check mark.
bool toggle(const char* label, bool& value);
/// A choice among a few, side by side; true when another was made.
bool choice(const char* label, int& value, std::initializer_list<const char*> names);

/// A label at the left of what comes next, which gets the rest of the line.
void label(const char* text);
/// The title of a panel's section with an arrow that closes it.
bool section(const char* title, bool& open);
void muted(const std::string& text);
void wrapped(const std::string& text, Rgb color);
/// Puts the next item, about so wide, beside the last one where there is room, else on a line of its own.
void flow(float width);
/// A hint in a muted colour beside the last item, as much of it as there is room for; all of it as its tooltip.
void hint(const std::string& text);
/// A text as long as there is room for, with an ellipsis where there is not.
std::string shortened(const std::string& text, float width);

}  // namespace rebake::ui
