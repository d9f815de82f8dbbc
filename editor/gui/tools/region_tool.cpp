#include "editor/gui/tools/region_tool.h"

#include <GLFW/glfw3.h>

#include <algorithm>

#include "editor/edits/select/select_picture.h"
#include "editor/edits/shape/erase.h"

namespace rebake {

namespace {

constexpr double least_step = 2;      // pixels between points of a freehand line
constexpr double closing_reach = 10;  // pixels from a polygon's first corner that close it

PictureFields picture_of(const Desk& desk) {
  PictureFields picture;
  picture.camera = desk.view.camera;
  picture.size = {desk.view.width, desk.view.height};
  return picture;
}

}  // namespace

void RegionTool::pointer(Desk& desk, const Lens& /*lens*/, const Pointer& pointer) {
  if (pointer.pressed && pointer.inside && points_.empty()) mode_ = select_mode(pointer);
  if (kind_ == ToolKind::polygon) {
    if (!pointer.pressed || !pointer.inside) return;
    const bool closes = points_.size() >= 3 && (points_.front() - pointer.at).norm() < closing_reach;
    if (!closes && !pointer.double_clicked) points_.push_back(pointer.at);
    if (closes || (pointer.double_clicked && points_.size() >= 3)) finish(desk);
    return;
  }
  if (pointer.pressed && pointer.inside) points_ = {pointer.at};
  if (points_.empty()) return;
  if (kind_ == ToolKind::rectangle) {
    points_.resize(1);
    points_.push_back(pointer.at);
  } else if ((points_.back() - pointer.at).norm() >= least_step) {
    points_.push_back(pointer.at);
  }
  if (pointer.released) finish(desk);
}

void RegionTool::finish(Desk& desk) {
  const std::vector<Vec2> points = std::exchange(points_, {});
  PictureFields picture = picture_of(desk);
  if (paints()) {
    picture.brush = BrushStroke{points, desk.settings.brush_radius};
  } else if (kind_ == ToolKind::rectangle) {
    const Vec2 &a = points.front(), &b = points.back();
    if (std::abs(a.x() - b.x()) < 1 || std::abs(a.y() - b.y()) < 1) return;  // a click
    picture.polygon = PixelPolygon{{a, {b.x(), a.y()}, b, {a.x(), b.y()}}};
  } else {
    if (points.size() < 3) return;
    picture.polygon = PixelPolygon{points};
  }
  if (kind_ == ToolKind::erase) {
    Erase erase;
    erase.picture = picture;
    erase.through = !desk.tools.visible_only;
    desk.edit(erase);
    return;
  }
  SelectPicture select;
  select.picture = picture;
  select.through = !desk.tools.visible_only;
  select.mode = mode_;
  desk.edit(select);
}

void RegionTool::draw(const Desk& desk, const Lens& /*lens*/, const Pointer& pointer, ImDrawList& list,
                      const ImVec2& origin) const {
  constexpr ImU32 light = IM_COL32(255, 255, 255, 230), dark = IM_COL32(0, 0, 0, 160);
  if (paints()) {
    const auto radius = static_cast<float>(desk.settings.brush_radius);
    for (const Vec2& point : points_)
      list.AddCircleFilled(on_screen(point, origin), radius, IM_COL32(255, 140, 20, 24), 24);
    if (!pointer.inside) return;
    list.AddCircle(on_screen(pointer.at, origin), radius + 1, dark, 48);
    list.AddCircle(on_screen(pointer.at, origin), radius, light, 48);
    return;
  }
  if (points_.empty()) return;
  std::vector<ImVec2> line;
  if (kind_ == ToolKind::rectangle) {
    const Vec2 &a = points_.front(), &b = points_.back();
    for (const Vec2& p : {a, Vec2(b.x(), a.y()), b, Vec2(a.x(), b.y())}) line.push_back(on_screen(p, origin));
  } else {
    for (const Vec2& p : points_) line.push_back(on_screen(p, origin));
    if (kind_ == ToolKind::polygon) line.push_back(on_screen(pointer.at, origin));
  }
  // Light over dark shows on any picture.
  list.AddPolyline(line.data(), static_cast<int>(line.size()), dark, ImDrawFlags_Closed, 3);
  list.AddPolyline(line.data(), static_cast<int>(line.size()), light, ImDrawFlags_Closed, 1);
}

bool RegionTool::key(Desk& desk, const KeyPress& press) {
  if (kind_ != ToolKind::polygon || points_.size() < 3 || press.key != GLFW_KEY_ENTER) return false;
  finish(desk);
  return true;
}

void RegionTool::options(Desk& desk) {
  ImGui::Checkbox("visible only", &desk.tools.visible_only);
  if (paints()) {
    auto radius = static_cast<float>(desk.settings.brush_radius);
    flow(150);
    ImGui::SetNextItemWidth(120);
    if (ImGui::SliderFloat("size", &radius, 1, 200, "%.0f px"))
      desk.settings.brush_radius = static_cast<double>(radius);
  }
  flow_text(kind_ == ToolKind::erase     ? "clears opacity under the stroke"
            : kind_ == ToolKind::polygon ? "click corners; Enter or the first corner closes"
                                         : "Shift adds, Ctrl removes, both intersect");
}

void RegionTool::cancel(Desk& /*desk*/) { points_.clear(); }

}  // namespace rebake
