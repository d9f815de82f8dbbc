#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "editor/edits/nodes/light.h"
#include "editor/gui/panels/panels.h"
#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/number_field.h"
#include "editor/gui/ui/widgets.h"

namespace rebake {

namespace {

LightEdit edit_for(const EditorContext& editor, const SceneLight& light, bool on) {
  LightEdit edit = light_edit(light, editor.scene());
  if (on) return edit;
  edit.effects = {"none"};
  edit.source = "estimated";
  edit.picture.clear();
  edit.content.clear();
  return edit;
}

// Renders a white diffuse ball in a light, seen from the front, on the panel's background; display colours.
Image ball_in(const Light& light, const Rgb& ground) {
  constexpr int side = 96;
  Image image{side, side, std::vector<std::uint8_t>(std::size_t{side} * side * 3)};
  std::vector<Vec3> directions;
  for (int k = 0; k < 256; ++k) {
    const double y = 1 - 2 * (k + 0.5) / 256, r = std::sqrt(1 - y * y), phi = 2.399963 * k;
    directions.emplace_back(r * std::cos(phi), y, r * std::sin(phi));
  }
  std::vector<Radiance> sky;
  for (const Vec3& d : directions) sky.push_back(light.sky.at(d));
  const auto lit = [&](const Vec3& n) {
    Radiance sum = Radiance::Zero();
    for (std::size_t k = 0; k < directions.size(); ++k) sum += 4.0 / 256 * std::max(0.0, n.dot(directions[k])) * sky[k];
    for (const Sun& sun : light.suns) sum += std::max(0.0, n.dot(sun.direction)) * sun.irradiance;
    return sum;
  };
  // Normalise the brightness, since only the light's shape and tint are known.
  double most = 1e-9;
  for (const Vec3& d : directions) most = std::max(most, lit(d).maxCoeff());
  const double behind[3] = {ground.r / 255.0, ground.g / 255.0, ground.b / 255.0};
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const double u = (x + 0.5) / side * 2 - 1, v = 1 - (y + 0.5) / side * 2, r2 = u * u + v * v;
      const double inside = std::clamp((0.96 - std::sqrt(r2)) * side / 2, 0.0, 1.0);
      const Vec3 n(u / 0.96, v / 0.96, std::sqrt(std::max(0.0, 1 - r2 / (0.96 * 0.96))));
      const Radiance e = inside > 0 ? Radiance(0.9 / most * lit(n.normalized())) : Radiance(0, 0, 0);
      for (int c = 0; c < 3; ++c) {
        const double shown = inside * std::clamp(to_display(e[c]), 0.0, 1.0) + (1 - inside) * behind[c];
        image.rgb[static_cast<std::size_t>((y * side + x) * 3 + c)] =
            static_cast<std::uint8_t>(std::lround(255 * shown));
      }
    }
  return image;
}

void draw_decisions(const Lighting& lighting) {
  const announce::Part part("decisions");
  if (!ImGui::BeginTable("decisions", 4, ImGuiTableFlags_SizingStretchProp)) return;
  ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthFixed, px(56));
  ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthStretch, 2);
  ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthStretch, 3);
  for (const LightDecision& decision : lighting.summary) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    if (decision.runs)
      ImGui::TextUnformatted("runs");
    else
      ImGui::TextDisabled("skipped");
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(ui::shortened(decision.name, ImGui::GetContentRegionAvail().x).c_str());
    ImGui::TableNextColumn();
    ImGui::TextDisabled("%s", ui::shortened(decision.words(), ImGui::GetContentRegionAvail().x).c_str());
    ui::tip(decision.name, "", decision.words());
  }
  ImGui::EndTable();
}

}  // namespace

void LightPanel::draw_ball(const Lighting& lighting) {
  if (lighting.lights.empty()) return;
  const std::shared_ptr<const Light>& light = lighting.lights.begin()->second;
  if (ball_of_ != light) {
    ball_.emplace(ball_in(*light, theme().panel));
    ball_of_ = light;
  }
  const float size = px(84);
  ImGui::Image(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(ball_->name())), {size, size});
  ui::tip("The light", "", "A white ball in the estimated or chosen light of the first object whose colours change.");
}

namespace {

// Toggles of the effects.
void draw_effects(EditorContext& editor, const SceneLight& light) {
  struct Wanted {
    const char* id;
    const char* name;
    const char* help;
    bool SceneLight::*wanted;
  };
  for (const Wanted& effect :
       {Wanted{"self", "Self-shadowing", "Updates the shadows of deformed parts on their own object.",
               &SceneLight::self},
        Wanted{"cast", "Shadows on others", "Objects cast shadows on each other.", &SceneLight::cast},
        Wanted{"removed", "Removed occluders", "Removes the shadows of removed objects.", &SceneLight::removed},
        Wanted{"highlights", "Highlights", "Keeps specular highlights fixed to the light when surfaces rotate.",
               &SceneLight::highlights},
        Wanted{"match", "Match lighting", "Lights all objects by the same light.", &SceneLight::match}}) {
    const bool highlights = effect.wanted == &SceneLight::highlights;
    // Highlights need the effect on the object itself: both follow from the motion of its triangles.
    if (highlights && !light.self) continue;
    bool wanted = light.*effect.wanted;
    ui::flow(px(100));
    // The last effect cannot be switched off. "Follows edits" switches off all of them.
    const bool only = wanted && !highlights && light.self + light.cast + light.removed + light.match == 1;
    if (ui::toggle((std::string(effect.name) + "##" + effect.id).c_str(), wanted) && !only) {
      SceneLight changed = light;
      changed.*effect.wanted = wanted;
      if (effect.wanted == &SceneLight::self) changed.highlights = wanted;
      editor.edit_light(edit_for(editor, changed, true));
    }
    ui::tip(effect.name, "", effect.help);
  }
}

// Choice of the light's source.
void draw_source(EditorContext& editor, const SceneLight& light) {
  int source = static_cast<int>(light.source);
  ui::label("Light");
  if (ui::choice("source", source,
                 {"Estimated##estimated", "Uniform##uniform", "Sky##sky", "Picture##environment-map"})) {
    SceneLight changed = light;
    changed.source = static_cast<SceneLight::Source>(source);
    if (changed.source == SceneLight::Source::picture && !changed.picture)
      editor.dialogs.path = FileDialogPurpose::light_picture;
    else
      editor.edit_light(edit_for(editor, changed, true));
  }
}

}  // namespace

void LightPanel::draw_settings(EditorContext& editor, const SceneLight& light, bool on) {
  bool follows = on;
  if (ui::toggle("Follows edits##follows-edits", follows)) editor.edit_light(edit_for(editor, light, follows));
  ui::tip("Light follows edits", "", "Updates shadows when objects are deformed, moved or removed.");
  if (!on) return;
  ImGui::SameLine();
  ui::toggle("As baked##as-baked", editor.view.as_baked);
  ui::tip("As baked", "", "Shows the baked colours without lighting effects, for comparison.");
  draw_effects(editor, light);
  draw_source(editor, light);
  if (!dragging_) {
    budget_ = light.budget * 255;
    sun_ = light.sun.direction;
    turn_ = light.picture_rotation * 180 / std::numbers::pi;
  }
  bool now_dragging = false;
  const auto field = [&](const char* id, double& value, const char* format, double step, double low, double high) {
    const ui::Changed changed = ui::number_field(id, value, format, step, px(84));
    value = std::clamp(value, low, high);
    now_dragging = now_dragging || changed == ui::Changed::dragged;
    return changed == ui::Changed::finished;
  };
  ui::label("Error budget");
  if (field("budget", budget_, "{:.2g} of 255", 0.05, 0, 255)) {
    SceneLight changed = light;
    changed.budget = budget_ / 255;
    editor.edit_light(edit_for(editor, changed, true));
  }
  ui::tip("Error budget", "", "Maximum colour error caused by skipped effects.");
  if (light.source == SceneLight::Source::sky) {
    bool finished = false;
    ui::label("Sun");
    for (int axis = 0; axis < 3; ++axis) {
      if (axis > 0) ImGui::SameLine();
      const char* const names[] = {"sun x", "sun y", "sun z"};
      finished = field(names[axis], sun_[axis], "{:.2f}", 0.02, -1, 1) || finished;
      ui::tip("Sun", "", "Direction towards the sun, in object space.");
    }
    if (finished && sun_.norm() > 1e-3) {
      SceneLight changed = light;
      changed.sun.direction = sun_;
      editor.edit_light(edit_for(editor, changed, true));
    }
  }
  if (light.source == SceneLight::Source::picture && light.picture) {
    ui::label("Environment map");
    const std::string name = std::filesystem::path(light.picture->path).filename().string();
    if (ui::button((ui::shortened(name, px(130)) + "###another picture").c_str()))
      editor.dialogs.path = FileDialogPurpose::light_picture;
    announce::item("another picture");
    ui::tip("Change environment map", "", light.picture->path);
    ImGui::SameLine();
    if (field("turn", turn_, "{:.0f}°", 1, -360, 360)) {
      SceneLight changed = light;
      changed.picture_rotation = turn_ * std::numbers::pi / 180;
      editor.edit_light(edit_for(editor, changed, true));
    }
    ui::tip("Rotate", "", "Rotates the environment map about the vertical axis.");
  }
  if (light.self) model_.draw(editor);
  dragging_ = now_dragging || (dragging_ && ImGui::IsMouseDown(ImGuiMouseButton_Left));
}

void LightPanel::draw(EditorContext& editor) {
  const announce::Part part("light");
  const bool on = editor.scene().light != nullptr;
  if (std::exchange(document_, editor.now->document) != editor.now->document) last_ = {};
  if (on) last_ = *editor.scene().light;
  const SceneLight light = last_;
  const std::shared_ptr<const Lighting> lighting = on ? editor.relighter.latest() : nullptr;
  const float left = std::min(px(352), 0.5F * ImGui::GetContentRegionAvail().x);
  ImGui::BeginChild("settings", {left, 0});
  draw_settings(editor, light, on);
  ImGui::EndChild();
  ImGui::SameLine();
  if (lighting && !lighting->lights.empty()) {
    ImGui::BeginChild("ball", {px(96), 0});
    draw_ball(*lighting);
    ImGui::EndChild();
    ImGui::SameLine();
  }
  ImGui::BeginChild("what");
  if (!on)
    ui::muted("Colours stay as baked when objects are deformed, moved or removed.");
  else if (const std::string problem = editor.relighter.problem(); !problem.empty())
    ui::muted(problem);
  else if (!lighting)
    ui::muted(editor.relighter.busy() ? "Computing the light …" : "No light computed yet.");
  else {
    if (editor.relighter.busy()) ui::muted("Refining …");
    draw_decisions(*lighting);
  }
  ImGui::EndChild();
}

}  // namespace rebake
