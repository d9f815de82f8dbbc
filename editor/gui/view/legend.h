#pragma once

#include "editor/gui/window/desk.h"

struct ImDrawList;
struct ImVec2;

namespace rebake {

/// What the picture's colours mean where they are not the scene's, and where it is cut, in its upper left corner.
void draw_legend(const Desk& desk, ImDrawList& list, const ImVec2& origin);

}  // namespace rebake
