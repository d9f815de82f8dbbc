#include "editor/gui/tools/picked_points.h"

#include <fmt/format.h>

#include <memory>

#include "editor/gui/ui/announce.h"

namespace rebake {

void pick_point(ToolContext& editor, const ViewportProjection& lens, const Vec2& at, const std::string& missed,
                std::function<void(const PickHit&)> found) {
  auto picked = std::make_shared<std::optional<PickHit>>();
  editor.jobs.worker.start(
      "pick", [picked, lens, at](Session& session) { *picked = pick(session.scene(), lens, at); },
      [&editor, picked, missed, found = std::move(found)] {
        if (*picked)
          found(**picked);
        else
          editor.messages.say(missed);
      });
}

void draw_points(const std::string& part, const std::vector<Vec3>& points, const ViewportProjection& lens,
                 ImDrawList& list, const ImVec2& origin, ImU32 color, bool numbers) {
  const announce::Part announced(part);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const auto pixel = lens.pixel(points[k]);
    if (!pixel) continue;
    const ImVec2 at = on_screen(*pixel, origin);
    announce::point(fmt::format("{}", k), at);
    list.AddCircleFilled(at, px(7), IM_COL32(0, 0, 0, 170));
    list.AddCircleFilled(at, px(5), color);
    if (numbers) draw_label(list, {at.x + px(14), at.y - ImGui::GetFontSize() / 2}, fmt::format("{}", k + 1));
  }
}

}  // namespace rebake
