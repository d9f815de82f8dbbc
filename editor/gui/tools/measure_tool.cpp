#include "editor/gui/tools/measure_tool.h"

#include <fmt/format.h>

#include <algorithm>

#include "editor/edits/nodes/set_length.h"
#include "editor/gui/tools/picked_points.h"
#include "editor/gui/ui/number_field.h"
#include "editor/gui/ui/widgets.h"

namespace rebake {

void MeasureTool::forget_stale(const ToolContext& editor) {
  if (!points_.empty() && editor.at_rest() && editor.scene().roots != roots_) points_.clear();
}

void MeasureTool::add(const ToolContext& editor, const Vec3& point) {
  roots_ = editor.scene().roots;
  if (points_.size() == 2) points_.clear();
  points_.push_back(point);
  if (points_.size() == 2) length_ = (points_[1] - points_[0]).norm();
}

void MeasureTool::pointer(ToolContext& editor, const ViewportProjection& lens, const Pointer& pointer) {
  if (click_.ends(pointer))
    pick_point(editor, lens, pointer.at, "There is no surface at this pixel. Click two points of surfaces.",
               [this, &editor](const PickHit& hit) { add(editor, hit.world); });
}

void MeasureTool::draw(const ToolContext& /*editor*/, const ViewportProjection& lens, const Pointer& /*pointer*/,
                       ImDrawList& list, const ImVec2& origin) const {
  draw_points("measure", points_, lens, list, origin, IM_COL32(250, 210, 90, 255));
  if (points_.size() < 2) return;
  const auto a = lens.pixel(points_[0]), b = lens.pixel(points_[1]);
  if (!a || !b) return;
  const ImVec2 from = on_screen(*a, origin), to = on_screen(*b, origin);
  list.AddLine(from, to, IM_COL32(0, 0, 0, 170), px(4));
  list.AddLine(from, to, IM_COL32(250, 210, 90, 255), px(2));
  draw_label(list, {std::max(from.x, to.x) + px(16), (from.y + to.y) / 2 - ImGui::GetFontSize() / 2},
             fmt::format("{:.5g}", (points_[1] - points_[0]).norm()));
}

void MeasureTool::options(ToolContext& editor) {
  forget_stale(editor);
  if (points_.size() < 2) {
    ui::hint(points_.empty() ? "Click two points of surfaces." : "Click the second point. Esc starts again.");
    return;
  }
  ImGui::AlignTextToFramePadding();
  ImGui::TextDisabled("Length");
  ImGui::SameLine();
  const double measured = (points_[1] - points_[0]).norm();
  const ui::Changed changed = ui::number_field("length", length_, "{:.6g}", measured / 200, px(100));
  ui::tip("Length", "", "The measured distance. Type the real one to scale the whole scene.");
  if (changed == ui::Changed::cancelled) length_ = measured;
  if (changed == ui::Changed::finished && length_ != measured) {
    SetLength edit;
    edit.points.points = points_;
    edit.length = length_;
    // The points scale with the scene.
    editor.edits_unchanged(
        {edit}, [roots = roots_](const Scene& scene) { return scene.roots == roots; },
        [this, &editor, factor = length_ / measured] {
          roots_ = editor.scene().roots;
          for (Vec3& point : points_) point *= factor;
        },
        [this, measured] { length_ = measured; });
  }
  const Vec3 step = (points_[1] - points_[0]).cwiseAbs();
  ui::hint(fmt::format("{:.5g} across, {:.5g} up, {:.5g} deep. Type the real length to scale the scene.", step.x(),
                       step.y(), step.z()));
}

void MeasureTool::cancel(ToolContext& /*editor*/) { points_.clear(); }

}  // namespace rebake
