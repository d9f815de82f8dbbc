#include "editor/gui/tools/volume_tool.h"

#include <GLFW/glfw3.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "editor/edits/select/select.h"
#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/widgets.h"

namespace rebake {

namespace {

constexpr float grab_pixels = 11;

Vec3 outwards(int side) {
  Vec3 axis(0, 0, 0);
  axis[side / 2] = side % 2 == 0 ? 1 : -1;
  return axis;
}

}  // namespace

void VolumeTool::place(const ToolContext& editor) {
  const Box box = editor.focus();
  if (box.isEmpty()) return;
  volume_.center = box.center();
  volume_.half = (box.diagonal() / 4).cwiseMax(box.diagonal().norm() / 50);
  if (sphere_) volume_.half.setConstant(volume_.half.mean());
}

Vec3 VolumeTool::handle(int number) const {
  if (number == middle) return volume_.center;
  return volume_.center + outwards(number).cwiseProduct(volume_.half);
}

int VolumeTool::handle_at(const ViewportProjection& lens, const Vec2& at) const {
  int found = none;
  double least = static_cast<double>(px(grab_pixels));
  for (int number = 0; number <= middle; ++number)
    if (const auto pixel = lens.pixel(handle(number)); pixel && (*pixel - at).norm() < least) {
      least = (*pixel - at).norm();
      found = number;
    }
  return found;
}

void VolumeTool::pointer(ToolContext& editor, const ViewportProjection& lens, const Pointer& pointer) {
  if (volume_.half.isZero(0)) place(editor);
  if (volume_.half.isZero(0)) return;
  if (held_ == none) {
    if (!pointer.pressed || !pointer.inside) return;
    held_ = handle_at(lens, pointer.at);
    before_ = volume_;
    from_ = pointer.at;
    return;
  }
  const Vec2 way = pointer.at - from_;
  const Volume last = std::exchange(volume_, before_);
  if (held_ == middle) {
    volume_.center = before_.center + lens.motion(before_.center, way);
  } else {
    const Vec3 axis = outwards(held_), at = handle(held_);
    const double step = static_cast<double>(px(50)) * lens.unit(at);
    const auto here = lens.pixel(at), there = lens.pixel(at + step * axis);
    // An axis along the view direction has no direction on the screen: the volume stays as it is.
    if (here && there && (*there - *here).norm() > 1) {
      const Vec2 along = *there - *here;
      const double moved = way.dot(along) / along.squaredNorm() * step;
      const double least = 1e-6 * before_.half.norm();
      if (sphere_) {
        volume_.half.setConstant(std::max(least, before_.half.x() + moved));
      } else {
        const int k = held_ / 2;
        volume_.half[k] = std::max(least, before_.half[k] + moved / 2);  // the opposite side stays
        volume_.center[k] += (volume_.half[k] - before_.half[k]) * axis[k];
      }
    } else {
      volume_ = last;
    }
  }
  if (pointer.released) held_ = none;
}

void VolumeTool::select(ToolContext& editor, SelectMode mode) const {
  Select edit;
  edit.mode = mode;
  if (sphere_)
    edit.sphere = SphereRegion{volume_.center, volume_.half.x()};
  else
    edit.box = BoxRegion{volume_.center - volume_.half, volume_.center + volume_.half};
  editor.edit_scope(edit);
}

bool VolumeTool::key(ToolContext& editor, const KeyPress& press) {
  if (busy() || (press.key != GLFW_KEY_ENTER && press.key != GLFW_KEY_KP_ENTER) || volume_.half.isZero(0)) return false;
  select(editor, press.shift ? SelectMode::add : press.control ? SelectMode::remove : SelectMode::set);
  return true;
}

void VolumeTool::draw(const ToolContext& /*editor*/, const ViewportProjection& lens, const Pointer& pointer,
                      ImDrawList& list, const ImVec2& origin) const {
  if (volume_.half.isZero(0)) return;
  const int hot = held_ != none ? held_ : pointer.inside ? handle_at(lens, pointer.at) : none;
  const announce::Part part("volume");
  const char* const names[] = {"+X", "-X", "+Y", "-Y", "+Z", "-Z", "middle"};
  for (int number = 0; number <= middle; ++number) {
    const auto pixel = lens.pixel(handle(number));
    if (!pixel) continue;
    const ImVec2 at = on_screen(*pixel, origin);
    announce::point(names[number], at);
    list.AddCircleFilled(at, px(6.5F), IM_COL32(0, 0, 0, 160));
    list.AddCircleFilled(at, px(5), number == hot ? IM_COL32(255, 230, 60, 255) : IM_COL32(120, 190, 255, 255));
  }
}

void VolumeTool::add_guides(const ToolContext& /*editor*/, Guides& guides) const {
  if (volume_.half.isZero(0)) return;
  const Color color(0.35, 0.65, 1);
  const auto line = [&](const Vec3& a, const Vec3& b) {
    guides.lines.push_back({volume_.center + a.cwiseProduct(volume_.half),
                            volume_.center + b.cwiseProduct(volume_.half), color, 0.95, 0.35});
  };
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 u(0, 0, 0), v(0, 0, 0), w(0, 0, 0);
    u[axis] = v[(axis + 1) % 3] = w[(axis + 2) % 3] = 1;
    if (!sphere_) {
      for (const double s : {-1.0, 1.0})
        for (const double t : {-1.0, 1.0}) line(s * v + t * w - u, s * v + t * w + u);
      continue;
    }
    constexpr int corners = 48;
    const auto at = [&](int k) {
      const double angle = 2 * std::numbers::pi * k / corners;
      return Vec3(std::cos(angle) * v + std::sin(angle) * w);
    };
    for (int k = 0; k < corners; ++k) line(at(k), at(k + 1));
  }
}

void VolumeTool::options(ToolContext& editor) {
  int shape = sphere_ ? 1 : 0;
  if (ui::choice("shape", shape, {"Box##box", "Sphere##sphere"})) {
    sphere_ = shape == 1;
    if (sphere_) volume_.half.setConstant(volume_.half.mean());
  }
  ImGui::BeginDisabled(volume_.half.isZero(0));
  ui::flow(px(70));
  if (ui::primary_button("Select")) select(editor, SelectMode::set);
  ui::tip("Select", "Enter", "Selects the triangles whose centre is inside the volume.");
  ui::flow(px(50));
  if (ui::button("Add##add")) select(editor, SelectMode::add);
  ui::tip("Add", "Shift+Enter");
  ui::flow(px(80));
  if (ui::button("Remove##remove")) select(editor, SelectMode::remove);
  ui::tip("Remove", "Ctrl+Enter");
  ui::flow(px(60));
  if (ui::button("Recentre")) place(editor);
  ui::tip("Recentre", "", "Moves the volume to the centre of the picked nodes, or of the scene.");
  ImGui::EndDisabled();
  ui::hint("Drag the centre to move the volume, or the sides to resize it.");
}

void VolumeTool::cancel(ToolContext& /*editor*/) {
  if (std::exchange(held_, none) != none) volume_ = before_;
}

}  // namespace rebake
