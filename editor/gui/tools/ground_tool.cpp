#include "editor/gui/tools/ground_tool.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "editor/edits/nodes/ground.h"
#include "editor/gui/tools/picked_points.h"
#include "editor/gui/ui/number_field.h"
#include "editor/gui/ui/widgets.h"

namespace rebake {

namespace {

// Edit that moves the plane to another height along its normal.
GroundEdit at_height(const Ground& ground, double height) {
  GroundEdit edit;
  if (ground.normal == Vec3::UnitY()) {
    edit.height = height;
    return edit;
  }
  const Mat3 frame = ground_frame(ground);
  const Vec3 foot = height * ground.normal;
  const double size = std::max(1.0, std::abs(height));
  edit.points.points = {foot, foot + size * frame.col(2), foot + size * frame.col(0)};
  return edit;
}

}  // namespace

void GroundTool::add(ToolContext& editor, const Vec3& point) {
  if (editor.scene().roots != roots_) points_.clear();
  roots_ = editor.scene().roots;
  points_.push_back(point);
  if (points_.size() < 3) return;
  GroundEdit edit;
  edit.points.points = std::exchange(points_, {});
  editor.edit(edit);
}

void GroundTool::pointer(ToolContext& editor, const ViewportProjection& lens, const Pointer& pointer) {
  if (click_.ends(pointer))
    pick_point(editor, lens, pointer.at, "There is no surface at this pixel. Click three points on the floor.",
               [this, &editor](const PickHit& hit) { add(editor, hit.world); });
}

void GroundTool::draw(const ToolContext& /*editor*/, const ViewportProjection& lens, const Pointer& /*pointer*/,
                      ImDrawList& list, const ImVec2& origin) const {
  draw_points("ground", points_, lens, list, origin, IM_COL32(120, 230, 140, 255));
}

void GroundTool::options(ToolContext& editor) {
  const Ground& ground = editor.scene().ground;
  if (!points_.empty() && editor.at_rest() && editor.scene().roots != roots_) points_.clear();
  if (!dragging_) height_ = ground.height;
  const Box box = world_bounds(editor.scene());
  const double size = box.isEmpty() || !(box.diagonal().norm() > 0) ? 1 : box.diagonal().norm();
  ImGui::AlignTextToFramePadding();
  ImGui::TextDisabled("Height");
  ImGui::SameLine();
  const ui::Changed changed =
      ui::number_field("height", height_, "{:.5g}", std::pow(10, std::floor(std::log10(size)) - 2), px(90));
  ui::tip("Height", "", "Height of the ground plane along its normal. Drag sideways, or click and type.");
  if (changed == ui::Changed::dragged) {
    dragging_ = true;
    editor.show_preview({at_height(ground, height_)});
  } else if (changed == ui::Changed::finished) {
    dragging_ = false;
    editor.edit_unchanged(at_height(ground, height_), [ground](const Scene& scene) { return scene.ground == ground; });
  } else if (changed == ui::Changed::cancelled) {
    dragging_ = false;
    editor.drop_preview();
  }
  ui::flow(px(110));
  GroundEdit edit;
  if (ui::button("Lowest point##lowest-point")) {
    edit.foot = true;
    editor.edit(edit);
  }
  ui::tip("Lowest point", "", "Levels the ground plane and moves it to the lowest visible point.");
  ui::flow(px(120));
  ImGui::BeginDisabled(editor.selected_triangles() == 0);
  if (ui::button("From selection")) {
    edit.selection = true;
    edit.nodes = editor.selected_nodes_if_picked();
    editor.edit(edit);
  }
  ImGui::EndDisabled();
  ui::tip("From selection", "", "Fits the ground plane to the selected triangles.");
  ui::hint(points_.empty() ? "Or click three points on the floor."
                           : fmt::format("{} of 3 points set. Esc clears them.", points_.size()));
}

void GroundTool::cancel(ToolContext& editor) {
  points_.clear();
  if (std::exchange(dragging_, false)) editor.drop_preview();
}

}  // namespace rebake
