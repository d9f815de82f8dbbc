#include "editor/gui/tools/ground_tool.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "editor/edits/nodes/ground.h"
#include "editor/gui/ui/announce.h"
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

void GroundTool::add(Desk& desk, const Vec3& point) {
  points_.push_back(point);
  if (points_.size() < 3) return;
  GroundEdit edit;
  edit.points.points = std::exchange(points_, {});
  desk.edit(edit);
}

void GroundTool::pointer(Desk& desk, const Lens& lens, const Pointer& pointer) {
  if (!click_.ends(pointer)) return;
  auto picked = std::make_shared<std::optional<Picked>>();
  desk.jobs.worker.start(
      "pick", [picked, lens, at = pointer.at](Session& session) { *picked = pick(session.scene(), lens, at); },
      [this, &desk, picked] {
        if (*picked)
          add(desk, (*picked)->world);
        else
          desk.messages.say("No surface there. Click three points of the floor.");
      });
}

void GroundTool::draw(const Desk& /*desk*/, const Lens& lens, const Pointer& /*pointer*/, ImDrawList& list,
                      const ImVec2& origin) const {
  const announce::Part part("ground");
  for (std::size_t k = 0; k < points_.size(); ++k) {
    const auto pixel = lens.pixel(points_[k]);
    if (!pixel) continue;
    const ImVec2 at = on_screen(*pixel, origin);
    announce::point(fmt::format("{}", k), at);
    list.AddCircleFilled(at, px(7), IM_COL32(0, 0, 0, 170));
    list.AddCircleFilled(at, px(5), IM_COL32(120, 230, 140, 255));
  }
}

void GroundTool::options(Desk& desk) {
  const Ground& ground = desk.scene().ground;
  if (!dragging_) height_ = ground.height;
  const Box box = world_bounds(desk.scene());
  const double size = box.isEmpty() || !(box.diagonal().norm() > 0) ? 1 : box.diagonal().norm();
  ImGui::AlignTextToFramePadding();
  ImGui::TextDisabled("Height");
  ImGui::SameLine();
  const ui::Changed changed =
      ui::number_field("Height", height_, "{:.5g}", std::pow(10, std::floor(std::log10(size)) - 2), px(90));
  ui::tip("Height", "", "Of the ground plane along its normal. Drag to the side, or click and type.");
  if (changed == ui::Changed::dragged) {
    dragging_ = true;
    desk.show_preview({at_height(ground, height_)});
  } else if (changed == ui::Changed::finished) {
    dragging_ = false;
    desk.edit(at_height(ground, height_));
  } else if (changed == ui::Changed::cancelled) {
    dragging_ = false;
    desk.drop_preview();
  }
  ui::flow(px(110));
  GroundEdit edit;
  if (ui::button("Scene's foot")) {
    edit.foot = true;
    desk.edit(edit);
  }
  ui::tip("Scene's foot", "", "Level, at the lowest point of everything visible.");
  ui::flow(px(120));
  ImGui::BeginDisabled(desk.selected_triangles() == 0);
  if (ui::button("From selection")) {
    edit.selection = true;
    desk.edit(edit);
  }
  ImGui::EndDisabled();
  ui::tip("From selection", "", "The plane that fits the selected triangles best.");
  ui::hint(points_.empty() ? "Or click three points of the floor."
                           : fmt::format("{} of 3 points. Esc starts again.", points_.size()));
}

void GroundTool::cancel(Desk& desk) {
  points_.clear();
  if (std::exchange(dragging_, false)) desk.drop_preview();
}

}  // namespace rebake
