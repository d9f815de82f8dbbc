#include "editor/gui/tools/region_tool.h"

#include <GLFW/glfw3.h>

#include <algorithm>

#include "editor/edits/select/select_picture.h"
#include "editor/edits/shape/erase.h"
#include "editor/gui/state/commands.h"
#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/widgets.h"

namespace rebake {

namespace {

constexpr double min_step = 2;        // minimum distance between points of a freehand line, pixels
constexpr double closing_reach = 10;  // a click this near to a polygon's first corner closes it, pixels

PictureFields picture_of(const ToolContext& editor) {
  PictureFields picture;
  picture.camera = editor.view.camera;
  picture.size = {editor.view.width, editor.view.height};
  return picture;
}

}  // namespace

void RegionTool::pointer(ToolContext& editor, const ViewportProjection& /*lens*/, const Pointer& pointer) {
  if (pointer.pressed && pointer.inside && points_.empty()) mode_ = select_mode(pointer);
  if (kind_ == ToolKind::polygon) {
    if (!pointer.pressed || !pointer.inside) return;
    const bool closes = points_.size() >= 3 && (points_.front() - pointer.at).norm() < closing_reach;
    if (!closes && !pointer.double_clicked) points_.push_back(pointer.at);
    if (closes || (pointer.double_clicked && points_.size() >= 3)) finish(editor);
    return;
  }
  if (pointer.pressed && pointer.inside) points_ = {pointer.at};
  if (points_.empty()) return;
  if (kind_ == ToolKind::rectangle) {
    points_.resize(1);
    points_.push_back(pointer.at);
  } else {
    // Uses all positions since the last frame, so that slow frames do not cut corners.
    for (const Vec2& at : pointer.way)
      if (!pointer.pressed && (points_.back() - at).norm() >= min_step) points_.push_back(at);
  }
  if (pointer.released) finish(editor);
}

void RegionTool::finish(ToolContext& editor) {
  const std::vector<Vec2> points = std::exchange(points_, {});
  PictureFields picture = picture_of(editor);
  if (paints()) {
    picture.brush = BrushStroke{points, editor.settings.brush_radius};
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
    erase.through = !editor.tools.visible_only();
    // One edit for all nodes, so that texels which it uncovers stay.
    for (const std::optional<NodeRef>& node : editor.scope())
      if (node) erase.nodes.push_back(*node);
    if (!editor.active.empty() && erase.nodes.empty())
      editor.say_why_nothing(false);
    else
      editor.edit(erase);
    return;
  }
  SelectPicture select;
  select.picture = picture;
  select.through = !editor.tools.visible_only();
  select.mode = mode_;
  editor.edit_scope(select);
}

void RegionTool::draw(const ToolContext& editor, const ViewportProjection& /*lens*/, const Pointer& pointer,
                      ImDrawList& list, const ImVec2& origin) const {
  constexpr ImU32 light = IM_COL32(255, 255, 255, 230), dark = IM_COL32(0, 0, 0, 160);
  if (paints()) {
    const auto radius = static_cast<float>(editor.settings.brush_radius);
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
  // A light line over a dark one is visible on any image.
  list.AddPolyline(line.data(), static_cast<int>(line.size()), dark, ImDrawFlags_Closed, 3);
  list.AddPolyline(line.data(), static_cast<int>(line.size()), light, ImDrawFlags_Closed, 1);
}

bool RegionTool::key(ToolContext& editor, const KeyPress& press) {
  if (kind_ != ToolKind::polygon || points_.size() < 3 || press.key != GLFW_KEY_ENTER) return false;
  finish(editor);
  return true;
}

void RegionTool::options(ToolContext& editor) {
  ui::toggle("Visible only##visible-only", editor.tools.visible_only());
  ui::tip("Visible only", command_key("Visible only", editor.settings),
          "Selects only visible triangles. Off: also those behind them.");
  if (paints()) {
    auto radius = static_cast<float>(editor.settings.brush_radius);
    ui::flow(px(185));
    ImGui::AlignTextToFramePadding();
    ImGui::TextDisabled("Size");
    ImGui::SameLine();
    ImGui::SetNextItemWidth(px(140));
    if (ImGui::SliderFloat("##size", &radius, 1, 200, "%.0f px"))
      editor.settings.brush_radius = static_cast<double>(radius);
    announce::item("Size");
  }
  ui::hint(kind_ == ToolKind::erase     ? "Paint over texels to make them transparent."
           : kind_ == ToolKind::polygon ? "Click corners. Press Enter or click the first corner to close the polygon."
                                        : "Shift adds, Ctrl removes, both intersect.");
}

void RegionTool::cancel(ToolContext& /*editor*/) { points_.clear(); }

}  // namespace rebake
