#include <fmt/format.h>
#include <imgui.h>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>

#include "editor/gui/panels/euler.h"
#include "editor/gui/panels/panels.h"
#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/fonts.h"
#include "editor/gui/ui/icons.h"
#include "editor/gui/ui/widgets.h"

namespace rebake {

using nlohmann::json;

namespace {

using Kind = AdjustableField::Kind;

Vec3 point_of(const json& value, double otherwise) {
  if (value.is_number()) return Vec3::Constant(value.get<double>());
  if (!value.is_array() || value.size() != 3) return Vec3::Constant(otherwise);
  return {value[0].get<double>(), value[1].get<double>(), value[2].get<double>()};
}

// Draws number fields for a field and writes changes to `object`. `unit`: change of a length per pixel of drag.
// `angles`: those of a rotation during a drag, because a rotation has several.
ui::Changed draw_values(const AdjustableField& field, json& object, double unit, std::optional<Vec3>& angles) {
  const json held = object.contains(field.field) ? object.at(field.field) : json();
  if (field.kind == Kind::point || field.kind == Kind::factors || field.kind == Kind::rotation) {
    Vec3 value = point_of(held, field.kind == Kind::factors ? 1 : 0);
    if (field.kind == Kind::rotation) {
      const auto q = held.is_array() && held.size() == 4
                         ? Eigen::Quaterniond(held[0].get<double>(), held[1].get<double>(), held[2].get<double>(),
                                              held[3].get<double>())
                         : Eigen::Quaterniond::Identity();
      value = euler_degrees(q.toRotationMatrix());
      for (double& angle : value)
        if (std::abs(angle) < 1e-10) angle = 0;
      if (angles) value = *angles;
    }
    const float width = (ImGui::GetContentRegionAvail().x - 2 * ImGui::GetStyle().ItemSpacing.x) / 3;
    const double step = field.kind == Kind::point ? unit : field.kind == Kind::rotation ? 1 : 0.01;
    ui::Changed result = ui::Changed::nothing;
    for (int axis = 0; axis < 3; ++axis) {
      if (axis > 0) ImGui::SameLine();
      const char name[] = {static_cast<char>('X' + axis), 0};
      const ui::Changed changed = ui::number_field(name, value[axis], "{:.4g}", step, width);
      if (changed != ui::Changed::nothing) result = changed;
    }
    if (result != ui::Changed::dragged && result != ui::Changed::finished) return result;
    if (field.kind == Kind::rotation) {
      angles = value;
      const Eigen::Quaterniond q(rotation_of(value));
      object[field.field] = {q.w(), q.x(), q.y(), q.z()};
    } else {
      object[field.field] = {value.x(), value.y(), value.z()};
    }
    return result;
  }
  double value = held.is_number() ? held.get<double>() : 0;
  const double step = field.kind == Kind::degrees  ? 1
                      : field.kind == Kind::length ? unit
                      : field.kind == Kind::factor ? 0.01
                                                   : 1;
  const ui::Changed changed = ui::number_field("value", value, field.kind == Kind::degrees ? "{:.4g}°" : "{:.4g}", step,
                                               ImGui::GetContentRegionAvail().x);
  if (changed != ui::Changed::dragged && changed != ui::Changed::finished) return changed;
  if (field.kind == Kind::number)
    object[field.field] = std::max(1, static_cast<int>(std::lround(value)));
  else
    object[field.field] =
        field.kind == Kind::length && std::string_view(field.field) == "falloff" ? std::max(0.0, value) : value;
  return changed;
}

// Draws a labelled field and writes changes to `object`.
ui::Changed draw_field(const AdjustableField& field, json& object, double unit, std::optional<Vec3>& angles) {
  ui::label(field.label);
  const announce::Part part(field.field);
  ImGui::PushID(field.label);
  const ui::Changed changed = draw_values(field, object, unit, angles);
  ImGui::PopID();
  return changed;
}

}  // namespace

void AdjustPanel::draw(ToolContext& editor, const ImVec2& corner, const ImVec2& room) {
  const Snapshot& now = *editor.now;
  // A drag ends with its step, for example by undo.
  if (changing_ && (!of_ || now.done.empty() || now.done.back().value() != of_->value())) {
    changing_ = false;
    of_.reset();
    ui::cancel_drag();
    editor.drop_preview();
  }
  if (now.steps_done == 0 || !now.before_last) return;
  const std::size_t edits = now.steps[now.steps_done - 1].edits;
  const Edit& last = now.done.back();
  const std::span<const AdjustableField> fields = last.type().adjustable;
  if (fields.empty()) return;
  for (std::size_t k = 0; k < edits; ++k)
    if (&now.done[now.done.size() - 1 - k].type() != &last.type()) return;
  if ((!of_ || of_->value() != last.value()) && !changing_) {
    of_ = last;
    object_ = to_json(last);
  }
  ImGui::SetNextWindowPos({corner.x + px(12), corner.y - px(12)}, ImGuiCond_Always, {0, 1});
  ImGui::SetNextWindowSizeConstraints({px(290), 0}, {px(290), px(600)});
  ImGui::PushStyleColor(ImGuiCol_WindowBg, color(theme().panel, 0.96F));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, px(6));
  ImGui::Begin("adjust", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoFocusOnAppearing);
  ImGui::PopStyleVar();
  ImGui::PopStyleColor();
  const announce::Part part("adjust");
  const std::string& title = now.steps[now.steps_done - 1].title;
  ui::section(ui::shortened(title, px(230)).c_str(), was_small_ ? opened_small_ : editor.settings.adjust_open);
  ui::tip(title, "F9", "Adjusts the last step. Changing a field applies the step again.");
  ui::Changed changed = ui::Changed::nothing;
  // In a small viewport only the title is shown, until a click opens the panel.
  const bool small = room.x < px(560) || room.y < px(330);
  if (small && !std::exchange(was_small_, small)) opened_small_ = false;
  was_small_ = small;
  if (small ? opened_small_ : editor.settings.adjust_open) {
    const double size =
        std::max(1e-300, world_bounds(now.scene).isEmpty() ? 1 : world_bounds(now.scene).diagonal().norm());
    const double unit = std::pow(10, std::floor(std::log10(size)) - 2);
    if (!changing_) angles_.reset();
    ImGui::PushID(static_cast<int>(now.steps_done));  // a text box must not outlive its step either
    for (const AdjustableField& field : fields)
      if (const ui::Changed one = draw_field(field, object_, unit, angles_); one != ui::Changed::nothing) changed = one;
    ImGui::PopID();
  }
  ImGui::End();
  if (changed == ui::Changed::cancelled) {
    of_.reset();
    changing_ = false;
    editor.drop_preview();
  }
  if (changed != ui::Changed::dragged && changed != ui::Changed::finished) return;
  try {
    const std::vector<Edit> list = changed_edits(now, edits);
    changing_ = changed == ui::Changed::dragged;
    if (changing_) {
      editor.show_preview(list, *now.before_last);
    } else {
      // The step that was made is the panel's own: a drag that has begun since goes on.
      editor.adjust(
          list,
          [this, &editor] {
            if (changing_) of_ = editor.now->done.back();
          },
          [this] { of_.reset(); });
    }
  } catch (const std::exception& error) {
    editor.messages.fail(error.what());
    object_ = to_json(last);
    changing_ = false;
    editor.drop_preview();
  }
}

std::vector<Edit> AdjustPanel::changed_edits(const Snapshot& now, std::size_t edits) const {
  std::vector<Edit> list;
  for (std::size_t k = now.done.size() - edits; k < now.done.size(); ++k) {
    json object = to_json(now.done[k]);
    for (const AdjustableField& field : now.done[k].type().adjustable)
      if (object_.contains(field.field)) object[field.field] = object_.at(field.field);
    list.push_back(read_edit(object, *now.before_last));
  }
  return list;
}

}  // namespace rebake
