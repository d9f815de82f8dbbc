#include "editor/gui/view/axes.h"

#include <algorithm>
#include <array>
#include <string>

#include "editor/gui/state/navigation.h"
#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/style.h"

namespace rebake {

bool draw_axes(Camera& camera, ImDrawList& list, const ImVec2& corner, bool over) {
  const float arm = px(32), knob = px(9);
  const ImVec2 middle{corner.x - arm - px(18), corner.y + arm + px(18)};
  const announce::Part part("axes");
  const Mat3 rows = world_to_camera(camera);
  struct Knob {
    double depth;
    ImVec2 at;
    Vec3 axis;
    int number;
  };
  std::array<Knob, 6> knobs;
  for (int k = 0; k < 6; ++k) {
    Vec3 axis(0, 0, 0);
    axis[k / 2] = k % 2 == 0 ? 1 : -1;
    const Vec3 seen = rows * axis;
    knobs[static_cast<std::size_t>(k)] = {
        seen.z(),
        {middle.x + arm * static_cast<float>(seen.x()), middle.y - arm * static_cast<float>(seen.y())},
        axis,
        k};
  }
  std::sort(knobs.begin(), knobs.end(), [](const Knob& a, const Knob& b) { return a.depth < b.depth; });
  bool hovered = false;
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  for (const Knob& one : knobs) {
    const bool positive = one.number % 2 == 0;
    const int axis = one.number / 2;
    const ImU32 color = axis == 0   ? IM_COL32(235, 70, 70, positive ? 255 : 110)
                        : axis == 1 ? IM_COL32(100, 200, 60, positive ? 255 : 110)
                                    : IM_COL32(70, 130, 245, positive ? 255 : 110);
    if (positive) list.AddLine(middle, one.at, color, px(2));
    list.AddCircleFilled(one.at, positive ? knob : knob - px(3), color);
    if (positive) {
      const char letter[] = {static_cast<char>('X' + axis), 0};
      const ImVec2 size = ImGui::CalcTextSize(letter);
      list.AddText({one.at.x - size.x / 2, one.at.y - size.y / 2}, IM_COL32(0, 0, 0, 255), letter);
    }
    announce::point(std::string(positive ? "+" : "-") + static_cast<char>('X' + axis), one.at);
    const float dx = mouse.x - one.at.x, dy = mouse.y - one.at.y;
    if (dx * dx + dy * dy > knob * knob || !over) continue;
    hovered = true;
    if (ImGui::IsMouseClicked(ImGuiMouseButton_Left)) camera = along_axis(camera, one.axis);
  }
  return hovered;
}

}  // namespace rebake
