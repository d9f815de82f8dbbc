#pragma once

#include <imgui.h>

#include "editor/gui/ui/theme.h"

namespace rebake {

/// Gives Dear ImGui a theme's colours and distances. `scale`: pixels of the screen a pixel of a plain one.
void set_style(const Theme& theme, float scale);
/// What set_style() was given last.
const Theme& theme();
/// A distance of a plain screen, in pixels of this one.
float px(float plain);

inline ImVec4 color(Rgb c, float opacity = 1) {
  return {static_cast<float>(c.r) / 255, static_cast<float>(c.g) / 255, static_cast<float>(c.b) / 255, opacity};
}
inline ImU32 color32(Rgb c, float opacity = 1) { return ImGui::ColorConvertFloat4ToU32(color(c, opacity)); }

}  // namespace rebake
