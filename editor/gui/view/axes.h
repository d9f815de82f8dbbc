#pragma once

#include "mesh_ops/scene/camera.h"

struct ImDrawList;
struct ImVec2;

namespace rebake {

/// Draws the navigation gizmo (six axis knobs) inside the viewport's upper right `corner`. A click on a knob makes the
/// camera look along that axis. `over`: the pointer is over the viewport and no drag is active. True if it hovers a
/// knob.
bool draw_axes(Camera& camera, ImDrawList& list, const ImVec2& corner, bool over);

}  // namespace rebake
