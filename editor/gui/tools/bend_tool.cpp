#include "editor/gui/tools/bend_tool.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "editor/edits/deform/bend.h"
#include "editor/edits/deform/deforming.h"
#include "editor/edits/deform/stretch.h"
#include "editor/edits/deform/taper.h"
#include "editor/edits/deform/twist.h"

namespace rebake {

namespace {

constexpr double bend_grab_pixels = 11;

}  // namespace

std::optional<BendTool::Spine> BendTool::spine(const Desk& desk) const {
  const std::optional<DeformTarget> target = desk.deform_target();
  if (!target) return std::nullopt;
  const Box box = desk.deform_bounds(*target);
  if (box.isEmpty()) return std::nullopt;
  int axis = axis_ - 1;
  if (axis < 0) {
    axis = 1;  // objects stand
    if (target->selection) box.sizes().maxCoeff(&axis);
  }
  const double length = box.sizes()[axis];
  if (!(length > 0)) return std::nullopt;
  Spine spine{*target, box.center(), Vec3::Unit(axis), length};
  spine.foot[axis] = box.min()[axis];
  // A selected part is held at the end where the rest is: a branch at the stem.
  if (axis_ == 0 && target->selection) {
    Box whole;
    for (const PlacedNode& placed : placed_nodes(desk.scene()))
      if (placed.visible && !placed.locked && placed.node->selection && count(*placed.node->selection) > 0)
        whole.extend(subtree_bounds(desk.scene(), placed.node->id));
    if (whole.center()[axis] > box.center()[axis]) {
      spine.along = -spine.along;
      spine.foot[axis] = box.max()[axis];
    }
  }
  return spine;
}

Vec3 BendTool::place(const Spine& spine, Handle handle) const {
  return handle == Handle::from ? spine.at(from_) : handle == Handle::to ? spine.at(to_) : spine.tip();
}

BendTool::Handle BendTool::handle_at(const Spine& spine, const Lens& lens, const Vec2& at) const {
  for (const Handle handle : {Handle::tip, Handle::to, Handle::from})
    if (const auto pixel = lens.pixel(place(spine, handle)); pixel && (*pixel - at).norm() < bend_grab_pixels)
      return handle;
  return Handle::none;
}

std::optional<Edit> BendTool::edit(const Lens& lens) const {
  const auto foot = lens.pixel(bent_->at(from_)), tip = lens.pixel(bent_->tip());
  if (!foot || !tip || !(to_ > from_)) return std::nullopt;
  const Vec2 before = *tip - *foot, after = before + (now_ - began_);
  const auto fill = [&](auto made) -> Edit {
    made.target = bent_->target;
    made.target.falloff = falloff_;
    made.axis.axis = bent_->along;
    made.axis.origin = bent_->foot;
    made.axis.from = from_ * bent_->length;
    made.axis.to = to_ * bent_->length;
    return made;
  };
  switch (kind_) {
    case Kind::bend: {
      Bend bend;
      // The tip lies half the bend's angle off, as seen from its foot; it goes where the pointer goes on the screen.
      const double angle = std::atan2(before.x() * after.y() - before.y() * after.x(), before.dot(after));
      const Vec3 away = -lens.towards_eye(bent_->at(0.5));
      const Vec3 side = away.cross(bent_->along);
      if (!(side.norm() > 0.05)) return std::nullopt;  // the axis points at the eye
      bend.degrees = typed_.value() ? *typed_.value() : std::abs(angle) * 2 * 180 / std::numbers::pi;
      bend.direction = (angle > 0 ? 1.0 : -1.0) * side.normalized();
      if (std::abs(bend.degrees) < 0.1) return std::nullopt;
      return fill(bend);
    }
    case Kind::twist: {
      Twist twist;
      twist.degrees = typed_.value().value_or(now_.x() - began_.x());
      if (twist.degrees == 0) return std::nullopt;
      return fill(twist);
    }
    case Kind::taper: {
      Taper taper;
      taper.factor = typed_.value().value_or(std::max(0.01, 1 + (now_.x() - began_.x()) / 150));
      if (taper.factor == 1) return std::nullopt;
      return fill(taper);
    }
    default: {
      Stretch stretch;
      stretch.factor = typed_.value().value_or(std::max(0.01, after.dot(before) / before.squaredNorm()));
      if (!std::isfinite(stretch.factor) || stretch.factor == 1) return std::nullopt;
      return fill(stretch);
    }
  }
}

void BendTool::pointer(Desk& desk, const Lens& lens, const Pointer& pointer) {
  if (held_ == Handle::none) {
    if (!pointer.pressed || !pointer.inside) return;
    bent_ = spine(desk);
    if (!bent_) return;
    held_ = handle_at(*bent_, lens, pointer.at);
    began_ = now_ = pointer.at;
    typed_.clear();
    typed_text_.clear();
    return;
  }
  const bool moved = now_ != pointer.at || typed_text_ != typed_.text();
  typed_text_ = typed_.text();
  now_ = pointer.at;
  if (held_ == Handle::tip) {
    const std::optional<Edit> made = edit(lens);
    readout_ = made ? readout(*made) : "";
    if (pointer.released) {
      held_ = Handle::none;
      if (made)
        desk.edit(*made);
      else
        desk.preview.reset();
    } else if (moved) {
      desk.preview.reset();
      try {
        if (made) desk.show_preview(rebake::apply(desk.scene(), *made).scene);
      } catch (const Error&) {
        desk.preview.reset();  // said on release
      }
    }
    return;
  }
  // A limit goes to where the pointer is nearest to the spine on the screen.
  const auto foot = lens.pixel(bent_->at(0)), top = lens.pixel(bent_->at(1));
  if (foot && top && (*top - *foot).squaredNorm() > 1) {
    const double share = std::clamp((now_ - *foot).dot(*top - *foot) / (*top - *foot).squaredNorm(), 0.0, 1.0);
    constexpr double least = 0.02;
    if (held_ == Handle::from)
      from_ = std::min(share, to_ - least);
    else
      to_ = std::max(share, from_ + least);
  }
  if (pointer.released) held_ = Handle::none;
}

bool BendTool::key(Desk& /*desk*/, const KeyPress& press) { return held_ == Handle::tip && typed_.key(press); }

std::string BendTool::readout(const Edit& edit) {
  if (const auto* bend = edit.as<Bend>()) return fmt::format("bend {:.1f} deg", bend->degrees);
  if (const auto* twist = edit.as<Twist>()) return fmt::format("twist {:.1f} deg", twist->degrees);
  if (const auto* taper = edit.as<Taper>()) return fmt::format("taper x {:.3f}", taper->factor);
  if (const auto* stretch = edit.as<Stretch>()) return fmt::format("stretch x {:.3f}", stretch->factor);
  return "";
}

void BendTool::draw(const Desk& desk, const Lens& lens, const Pointer& pointer, ImDrawList& list,
                    const ImVec2& origin) const {
  const std::optional<Spine> here = held_ != Handle::none ? bent_ : spine(desk);
  if (!here) return;
  const Handle hot = held_ != Handle::none ? held_ : pointer.inside ? handle_at(*here, lens, pointer.at) : Handle::none;
  for (const Handle handle : {Handle::from, Handle::to, Handle::tip}) {
    const auto pixel = lens.pixel(place(*here, handle));
    if (!pixel) continue;
    const bool drags = held_ == Handle::tip && handle == Handle::tip;
    const ImVec2 at = on_screen(drags ? Vec2(*pixel + now_ - began_) : *pixel, origin);
    list.AddCircleFilled(at, handle == Handle::tip ? 8.0F : 6.0F, IM_COL32(0, 0, 0, 170));
    list.AddCircleFilled(at, handle == Handle::tip ? 7.0F : 5.0F,
                         handle == hot           ? IM_COL32(255, 230, 60, 255)
                         : handle == Handle::tip ? IM_COL32(255, 120, 200, 255)
                                                 : IM_COL32(120, 190, 255, 255));
  }
  if (held_ != Handle::tip) return;
  draw_label(list, on_screen(now_ + Vec2(16, 16), origin),
             readout_ + (typed_.text().empty() ? "" : "  [" + typed_.text() + "]"));
}

void BendTool::add_guides(const Desk& desk, std::vector<Guides::Line>& lines) const {
  const std::optional<Spine> here = held_ != Handle::none ? bent_ : spine(desk);
  if (!here) return;
  lines.push_back({here->at(from_), here->at(to_), Color(0.35, 0.65, 1), 1, 0.6});
  lines.push_back({here->at(to_), here->tip(), Color(1, 0.5, 0.8), 1, 0.6});
}

void BendTool::options(Desk& desk) {
  int kind = static_cast<int>(kind_);
  ImGui::SetNextItemWidth(90);
  if (ImGui::Combo("##kind", &kind, "bend\0twist\0taper\0stretch\0")) kind_ = static_cast<Kind>(kind);
  flow(150);
  ImGui::SetNextItemWidth(95);
  ImGui::Combo("axis", &axis_, "automatic\0X\0Y\0Z\0");
  flow(150);
  ImGui::SetNextItemWidth(80);
  auto falloff = static_cast<float>(falloff_);
  if (ImGui::InputFloat("falloff", &falloff)) falloff_ = std::max(0.0, static_cast<double>(falloff));
  if (spine(desk))
    flow_text("drag the pink end, or type a number meanwhile; the blue ends are its limits");
  else
    flow_text("there is nothing to bend");
}

void BendTool::cancel(Desk& desk) {
  held_ = Handle::none;
  desk.preview.reset();
}

}  // namespace rebake
