#pragma once

#include <imgui.h>

#include "editor/gui/ui/theme.h"

namespace rebake {

/// Sets Dear ImGui's colours and spacing. `scale`: framebuffer pixels per logical pixel. `theme` must outlive its use.
void set_style(const Theme& theme, float scale);
/// The theme of the last set_style().
const Theme& theme();
/// Converts logical pixels to framebuffer pixels, by the scale of the last set_style().
float px(float plain);

inline ImVec4 color(Rgb c, float opacity = 1) {
  return {static_cast<float>(c.r) / 255, static_cast<float>(c.g) / 255, static_cast<float>(c.b) / 255, opacity};
}
inline ImU32 color32(Rgb c, float opacity = 1) { return ImGui::ColorConvertFloat4ToU32(color(c, opacity)); }

}  // namespace rebake
