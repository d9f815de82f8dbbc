#pragma once

#include <functional>
#include <string>
#include <vector>

#include "editor/gui/tools/tool.h"

namespace rebake {

/// Finds the surface point at a pixel in the background and passes it on; without one, shows the message `missed`.
/// Whatever `found` refers to must live as long as the window, as tools do.
void pick_point(ToolContext& editor, const ViewportProjection& lens, const Vec2& at, const std::string& missed,
                std::function<void(const PickHit&)> found);

/// Draws points in world space as dots, which are announced as "part/0", "part/1", …; with `numbers`, each has its
/// number, from 1, beside it.
void draw_points(const std::string& part, const std::vector<Vec3>& points, const ViewportProjection& lens,
                 ImDrawList& list, const ImVec2& origin, ImU32 color, bool numbers = false);

}  // namespace rebake
