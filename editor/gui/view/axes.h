#pragma once

#include "editor/gui/window/desk.h"

struct ImDrawList;
struct ImVec2;

namespace rebake {

/// The axes below the picture's upper right `corner`, whose knobs turn the camera. `over`: the pointer may take one.
/// True while it is on one.
bool draw_axes(Desk& desk, ImDrawList& list, const ImVec2& corner, bool over);

}  // namespace rebake
