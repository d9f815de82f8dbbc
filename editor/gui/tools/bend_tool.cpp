#include "editor/gui/tools/bend_tool.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "editor/edits/deform/bend.h"
#include "editor/edits/deform/deforming.h"
#include "editor/edits/deform/stretch.h"
#include "editor/edits/deform/taper.h"
#include "editor/edits/deform/target_spine.h"
#include "editor/edits/deform/twist.h"
#include "editor/edits/select/select_picture.h"
#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/number_field.h"
#include "editor/gui/ui/widgets.h"
#include "mesh_ops/deform/bends/curved_form.h"

namespace rebake {

namespace {

constexpr float bend_grab_pixels = 11;
constexpr double interleaved = 0.4;  // Spine::touched from which unselected triangles lie among the selected ones

// The deformation by an edit that was made along this spine; empty for other edits.
std::function<Deformed(const Vec3&)> deformation_along(const Edit& edit, const Spine& spine) {
  ClosedForm form;
  const DeformAxis* axis = nullptr;
  if (const auto* bend = edit.as<Bend>()) {
    form.radians = bend->degrees * std::numbers::pi / 180;
    form.direction = bend->direction;
    axis = &bend->axis;
  } else if (const auto* twist = edit.as<Twist>()) {
    form.kind = ClosedForm::Kind::twist;
    form.radians = twist->degrees * std::numbers::pi / 180;
    axis = &twist->axis;
  } else if (const auto* taper = edit.as<Taper>()) {
    form.kind = ClosedForm::Kind::taper;
    form.factor = taper->factor;
    axis = &taper->axis;
  } else if (const auto* stretch = edit.as<Stretch>()) {
    form.kind = ClosedForm::Kind::stretch;
    form.factor = stretch->factor;
    axis = &stretch->axis;
  }
  if (axis == nullptr || axis->axis != AxisDirection(spine.along) || !axis->from || !axis->to) return {};
  form.axis = spine.along;
  form.from = *axis->from;
  form.to = *axis->to;
  if (!axis->spine.points.empty()) {
    if (axis->spine.points != spine.curve) return {};
    return [curved = along_curve(form, spine.curve)](const Vec3& point) { return deform(curved, point); };
  }
  if (axis->origin != spine.foot) return {};
  form.origin = spine.foot;
  return [form](const Vec3& point) { return deform(form, point); };
}

}  // namespace

BendTool::SpineInputs BendTool::current_inputs(const ToolContext& editor) const {
  SpineInputs found{axis_, false, {}};
  std::set<NodeId> nodes;
  for (const DeformTarget& target : editor.deform_targets(&nodes)) found.selection = target.selection;
  for (const PlacedNode& placed : placed_nodes(editor.scene()))
    if (nodes.contains(placed.node->id)) found.nodes.push_back(placed.node);
  return found;
}

bool BendTool::last_edit_follows_spine(const ToolContext& editor) const {
  const std::optional<DeformAxisTarget> here = current_target(editor);
  return here && !editor.now->done.empty() && deformation_along(editor.now->done.back(), here->spine) != nullptr;
}

void BendTool::find_spine(ToolContext& editor) {
  const SpineInputs now = current_inputs(editor);
  if (now == spine_inputs_) return;
  const SpineInputs before = std::exchange(spine_inputs_, now);
  const auto same_node = [](const NodePtr& a, const NodePtr& b) { return a->id == b->id; };
  const bool same = now.axis == before.axis && now.selection == before.selection &&
                    std::equal(now.nodes.begin(), now.nodes.end(), before.nodes.begin(), before.nodes.end(), same_node);
  // A second edit of the same triangles keeps the axis and limits of the first.
  if (same && last_edit_follows_spine(editor)) return;
  found_.reset();
  from_ = 0;
  to_ = 1;
  flipped_ = false;
  const std::vector<DeformTarget> targets = editor.deform_targets();
  if (targets.empty()) return;
  if (axis_ > 0 || !targets.front().selection) {
    // Whole objects usually stand upright: use Y by default.
    const int axis = axis_ > 0 ? axis_ - 1 : 1;
    const Box box = editor.deform_bounds(targets);
    if (box.isEmpty() || !(box.sizes()[axis] > 0)) return;
    Spine spine;
    spine.foot = box.center();
    spine.along = Vec3::Unit(axis);
    spine.length = box.sizes()[axis];
    spine.foot[axis] = box.min()[axis];
    found_ = std::make_shared<Spine>(spine);
    return;
  }
  auto found = std::make_shared<Spine>();
  editor.jobs.worker.start(
      "searching for the spine",
      [targets, found](Session& session) { *found = spine_of_targets(session.scene(), targets); },
      [this, found, now] {
        if (now != spine_inputs_ || !(found->length > 0)) return;
        found_ = found;
        // A falloff as wide as the stem avoids a rip at the border. With unselected triangles in between, it would hold
        // everything in place.
        falloff_ = found->touched < interleaved ? found->width : 0;
      });
}

std::optional<BendTool::DeformAxisTarget> BendTool::current_target(const ToolContext& editor) const {
  if (!found_) return std::nullopt;
  DeformAxisTarget bent{editor.deform_targets(), *found_};
  if (bent.targets.empty()) return std::nullopt;
  if (flipped_) {
    bent.spine.foot += bent.spine.length * bent.spine.along;
    bent.spine.along = -bent.spine.along;
    std::reverse(bent.spine.curve.begin(), bent.spine.curve.end());
  }
  bent.curved = curved_ && kind_ != Kind::taper && bent.spine.curve.size() > 1;
  return bent;
}

Vec3 BendTool::shown(const ToolContext& editor, const DeformAxisTarget& bent, const Vec3& point) {
  const std::vector<Edit>& done = editor.now->done;
  std::size_t first = done.size();
  while (first > 0 && deformation_along(done[first - 1], bent.spine) != nullptr) --first;
  Vec3 result = point;
  // Each step has one edit per target, all with the same form: apply it once per step.
  for (std::size_t k = first; k < done.size(); k += bent.targets.size())
    result = deformation_along(done[k], bent.spine)(result).point;
  return result;
}

Vec3 BendTool::DeformAxisTarget::at(double share) const {
  if (!curved) return spine.foot + share * spine.length * spine.along;
  // Beyond its ends the curve is extrapolated linearly.
  const auto pieces = static_cast<double>(spine.curve.size() - 1);
  const double piece = std::clamp(std::floor(share * pieces), 0.0, pieces - 1);
  const auto k = static_cast<std::size_t>(piece);
  return spine.curve[k] + (share * pieces - piece) * (spine.curve[k + 1] - spine.curve[k]);
}

double BendTool::DeformAxisTarget::length_to(double share) const {
  if (!curved) return share * spine.length;
  const auto pieces = static_cast<double>(spine.curve.size() - 1);
  double length = 0;
  for (std::size_t k = 0; k + 1 < spine.curve.size(); ++k)
    length +=
        std::clamp(share * pieces - static_cast<double>(k), 0.0, 1.0) * (spine.curve[k + 1] - spine.curve[k]).norm();
  return length;
}

Vec3 BendTool::place(const DeformAxisTarget& bent, Handle handle) const {
  return handle == Handle::from ? bent.at(from_) : handle == Handle::to ? bent.at(to_) : bent.tip();
}

BendTool::Handle BendTool::handle_at(const ToolContext& editor, const DeformAxisTarget& bent,
                                     const ViewportProjection& lens, const Vec2& at) const {
  for (const Handle handle : {Handle::tip, Handle::to, Handle::from})
    if (const auto pixel = lens.pixel(shown(editor, bent, place(bent, handle)));
        pixel && (*pixel - at).norm() < static_cast<double>(px(bend_grab_pixels)))
      return handle;
  return Handle::none;
}

std::vector<Edit> BendTool::edits(const ToolContext& editor, const ViewportProjection& lens) const {
  const DeformAxisTarget& bent = *drag_target_;
  const auto foot = lens.pixel(shown(editor, bent, bent.at(from_))), tip = lens.pixel(shown(editor, bent, bent.tip()));
  if (!foot || !tip || !(to_ > from_)) return {};
  const Vec2 before = *tip - *foot, after = before + (now_ - began_);
  const auto fill = [&](auto made) {
    std::vector<Edit> list;
    for (const DeformTarget& target : bent.targets) {
      made.target = target;
      made.target.falloff = falloff_;
      made.axis.axis = bent.spine.along;
      if (bent.curved)
        made.axis.spine.points = bent.spine.curve;
      else
        made.axis.origin = bent.spine.foot;
      made.axis.from = bent.length_to(from_);
      made.axis.to = bent.length_to(to_);
      list.emplace_back(made);
    }
    return list;
  };
  switch (kind_) {
    case Kind::bend: {
      Bend bend;
      // Seen from the foot, the tip moves by half the bend's angle. It follows the pointer on the screen.
      const double angle = std::atan2(before.x() * after.y() - before.y() * after.x(), before.dot(after));
      const Vec3 away = -lens.direction_to_eye(bent.at(0.5));
      const Vec3 side = away.cross(bent.spine.along);
      if (!(side.norm() > 0.05)) return {};  // the axis points at the eye
      bend.degrees = typed_.value() ? *typed_.value() : std::abs(angle) * 2 * 180 / std::numbers::pi;
      bend.direction = (angle > 0 ? 1.0 : -1.0) * side.normalized();
      if (std::abs(bend.degrees) < 0.1) return {};
      return fill(bend);
    }
    case Kind::twist: {
      Twist twist;
      twist.degrees = typed_.value().value_or(now_.x() - began_.x());
      if (twist.degrees == 0) return {};
      return fill(twist);
    }
    case Kind::taper: {
      Taper taper;
      taper.factor = typed_.value().value_or(std::max(0.01, 1 + (now_.x() - began_.x()) / 150));
      if (taper.factor == 1) return {};
      return fill(taper);
    }
    default: {
      Stretch stretch;
      stretch.factor = typed_.value().value_or(std::max(0.01, after.dot(before) / before.squaredNorm()));
      if (!std::isfinite(stretch.factor) || stretch.factor == 1) return {};
      return fill(stretch);
    }
  }
}

void BendTool::pointer(ToolContext& editor, const ViewportProjection& lens, const Pointer& pointer) {
  if (held_ == Handle::none) {
    find_spine(editor);
    if (!pointer.pressed || !pointer.inside) return;
    drag_target_ = current_target(editor);
    if (!drag_target_) return;
    held_ = handle_at(editor, *drag_target_, lens, pointer.at);
    began_ = now_ = pointer.at;
    typed_.clear();
    typed_text_.clear();
    return;
  }
  const bool moved = now_ != pointer.at || typed_text_ != typed_.text();
  typed_text_ = typed_.text();
  now_ = pointer.at;
  if (held_ == Handle::tip) {
    const std::vector<Edit> made = edits(editor, lens);
    readout_ = made.empty() ? "" : readout(made.front());
    if (pointer.released) {
      held_ = Handle::none;
      if (made.empty()) {
        editor.drop_preview();
      } else {
        editor.edits(made);
      }
    } else if (moved && !made.empty()) {
      editor.show_preview(made);
    } else if (moved) {
      editor.drop_preview();
    }
    return;
  }
  // The limit is the pointer's projection onto the spine's chord on the screen.
  const auto foot = lens.pixel(drag_target_->at(0)), top = lens.pixel(drag_target_->at(1));
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

bool BendTool::key(ToolContext& /*editor*/, const KeyPress& press) { return held_ == Handle::tip && typed_.key(press); }

std::string BendTool::readout(const Edit& edit) {
  if (const auto* bend = edit.as<Bend>()) return fmt::format("Bend {:.1f}°", bend->degrees);
  if (const auto* twist = edit.as<Twist>()) return fmt::format("Twist {:.1f}°", twist->degrees);
  if (const auto* taper = edit.as<Taper>()) return fmt::format("Taper × {:.3f}", taper->factor);
  if (const auto* stretch = edit.as<Stretch>()) return fmt::format("Stretch × {:.3f}", stretch->factor);
  return "";
}

void BendTool::draw(const ToolContext& editor, const ViewportProjection& lens, const Pointer& pointer, ImDrawList& list,
                    const ImVec2& origin) const {
  const std::optional<DeformAxisTarget> here = held_ != Handle::none ? drag_target_ : current_target(editor);
  if (!here) return;
  const announce::Part part("bend");
  const Handle hot = held_ != Handle::none ? held_
                     : pointer.inside      ? handle_at(editor, *here, lens, pointer.at)
                                           : Handle::none;
  for (const auto& [handle, name] :
       {std::pair(Handle::from, "from"), std::pair(Handle::to, "to"), std::pair(Handle::tip, "tip")}) {
    const auto pixel = lens.pixel(shown(editor, *here, place(*here, handle)));
    if (!pixel) continue;
    const bool drags = held_ == Handle::tip && handle == Handle::tip;
    const ImVec2 at = on_screen(drags ? Vec2(*pixel + now_ - began_) : *pixel, origin);
    announce::point(name, at);
    list.AddCircleFilled(at, px(handle == Handle::tip ? 8 : 6), IM_COL32(0, 0, 0, 170));
    list.AddCircleFilled(at, px(handle == Handle::tip ? 7 : 5),
                         handle == hot           ? IM_COL32(255, 230, 60, 255)
                         : handle == Handle::tip ? IM_COL32(255, 120, 200, 255)
                                                 : IM_COL32(120, 190, 255, 255));
  }
  if (held_ != Handle::tip) return;
  draw_label(list, on_screen(now_ + Vec2(16, 16), origin),
             readout_ + (typed_.text().empty() ? "" : "  [" + typed_.text() + "]"));
}

void BendTool::add_guides(const ToolContext& editor, Guides& guides) const {
  const std::optional<DeformAxisTarget> here = held_ != Handle::none ? drag_target_ : current_target(editor);
  if (!here) return;
  // A polyline, since the spine may be curved.
  constexpr int pieces = 24;
  for (int k = 0; k < pieces; ++k) {
    const auto at = [&](int piece) { return shown(editor, *here, here->at(from_ + (to_ - from_) * piece / pieces)); };
    guides.lines.push_back({at(k), at(k + 1), Color(0.35, 0.65, 1), 1, 0.6});
  }
  guides.lines.push_back(
      {shown(editor, *here, here->at(to_)), shown(editor, *here, here->tip()), Color(1, 0.5, 0.8), 1, 0.6});
  // Shade the soft border. During drags, or with too many triangles, draw a ring of its width at the lower limit
  // instead.
  if (!(falloff_ > 0)) return;
  if (held_ == Handle::none && !editor.preview)
    guides.triangles = falloff_overlay_.of(editor.scene(), here->targets, falloff_);
  if (guides.triangles) return;
  const Vec3 middle = here->at(from_), u = here->spine.along.unitOrthogonal(), v = here->spine.along.cross(u);
  constexpr int corners = 32;
  for (int k = 0; k < corners; ++k) {
    const auto at = [&](int corner) {
      const double angle = 2 * std::numbers::pi * corner / corners;
      return Vec3(middle + falloff_ * (std::cos(angle) * u + std::sin(angle) * v));
    };
    guides.lines.push_back({at(k), at(k + 1), Color(1, 0.7, 0.2), 0.9, 0.4});
  }
}

void BendTool::options(ToolContext& editor) {
  int kind = static_cast<int>(kind_);
  if (ui::choice("kind", kind, {"Bend", "Twist", "Taper", "Stretch"})) kind_ = static_cast<Kind>(kind);
  ui::flow(px(130));
  ImGui::SetNextItemWidth(px(130));
  ImGui::Combo("##axis", &axis_, "along its shape\0along X\0along Y\0along Z\0");
  announce::item("Axis");
  ui::tip("Axis", "", "Along the shape: from the point where the selection is attached to its far end.");
  ui::flow(px(40));
  if (ui::button("Flip")) flipped_ = !flipped_;
  ui::tip("Flip", "", "Swaps the fixed end and the dragged end.");
  ui::flow(px(90));
  ImGui::BeginDisabled(!found_ || found_->curve.empty() || kind_ == Kind::taper);
  ui::toggle("Curved##curved", curved_);
  ImGui::EndDisabled();
  ui::tip("Curved", "", "Deforms along the curved centre line of the shape instead of a straight axis.");
  ui::flow(px(160));
  ImGui::AlignTextToFramePadding();
  ImGui::TextDisabled("Falloff");
  ImGui::SameLine();
  double falloff = falloff_;
  const double step = found_ ? found_->length / 200 : 0.01;
  const ui::Changed changed = ui::number_field("Falloff", falloff, "{:.3g}", step, px(70));
  if (changed == ui::Changed::dragged || changed == ui::Changed::finished) falloff_ = std::max(0.0, falloff);
  ui::tip("Falloff", "", "Width of the transition at the border of the selection, in scene units. 0: hard border.");
  if (found_ && found_->touched >= interleaved && editor.visible_selection_count() > 0) {
    ui::flow(px(180));
    if (ui::primary_button("Select occluded triangles##select-occluded")) {
      std::vector<Edit> all;
      for (SelectPicture one : editor.visible_selections()) {
        one.through = true;
        all.emplace_back(one);
      }
      editor.edits(all);
    }
    ui::tip("Select occluded triangles", "",
            "Only visible triangles are selected. Occluded ones would stay in place and tear the shape.");
  }
  if (found_ && found_->touched >= interleaved)
    ui::hint("Unselected triangles among the selection stay in place.");
  else if (current_target(editor))
    ui::hint("Drag the pink handle.");
  else
    ui::hint(editor.jobs.worker.busy() ? "Searching for the spine…"
                                       : "Nothing to deform. Select triangles or pick a node.");
}

void BendTool::cancel(ToolContext& editor) {
  held_ = Handle::none;
  falloff_overlay_ = {};
  editor.drop_preview();
}

}  // namespace rebake
