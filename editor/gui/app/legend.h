#pragma once

#include "editor/gui/state/view_state.h"

struct ImDrawList;
struct ImVec2;

namespace rebake {

/// Draws a legend at the viewport's upper left corner `origin`: the meaning of the colours of an inspection mode, or
/// the depth of the cutting plane (ViewState::cut). Draws nothing in the normal mode without a cut.
void draw_legend(const ViewState& view, ImDrawList& list, const ImVec2& origin);

}  // namespace rebake
