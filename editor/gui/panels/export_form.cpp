#include "editor/gui/panels/export_form.h"

#include <fmt/format.h>
#include <imgui.h>

#include <set>

#include "editor/actions/plain_report.h"
#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/widgets.h"

namespace rebake {

const Format& ExportForm::format() const { return format_named(inputs_.values().value("format", FormatName().name)); }

// How the decoder of a plain folder is chosen.
std::string ExportForm::choice_words() const {
  const nlohmann::json& values = inputs_.values();
  if (!values.contains("way")) return "the narrowest decoder that reaches 40 dB";
  return fmt::format("{}, width {}", notation_of(Codec<FuseMethod>::read(values["way"], {})),
                     values.contains("width") ? values["width"].dump() : "auto");
}

std::vector<std::string> ExportForm::losses(const Scene& scene) const {
  const bool plain = is_plain();
  std::vector<std::string> lines;
  if (format().name != FormatName().name)
    return {fmt::format("{}: {}, without the history", format().title, format().help)};
  std::size_t objects = 0, hidden = 0, turned = 0;
  for (const PlacedNode& placed : placed_nodes(scene)) {
    if (!placed.node->object) continue;
    placed.visible ? ++objects : ++hidden;
    if (placed.visible && placed.node->object->any_rotations()) ++turned;
  }
  if (plain) lines.emplace_back("one decoder is fitted to all objects; the message log reports its error in dB");
  if (objects > 1 && !plain)
    lines.push_back(fmt::format(
        "{} objects: one folder has one decoder in one orientation, and one file layout; objects that differ in these "
        "are written as a scene folder (scene.json), which only Rebake can open",
        objects));
  if (hidden > 0)
    lines.push_back(hidden == 1 ? std::string("1 hidden object is not exported")
                                : fmt::format("{} hidden objects are not exported", hidden));
  if (turned > 0 && !plain)
    lines.push_back(
        fmt::format("{} deformed: the plain format stores positions, but no rotated view directions; the message log "
                    "reports the error in dB",
                    turned == 1 ? std::string("1 object is") : fmt::format("{} objects are", turned)));
  lines.emplace_back("the plain format has no names, groups, stored views or history");
  return lines;
}

// The fields of ExportAction without an input of their own in the dialog that apply to the chosen format.
std::vector<FieldInfo> ExportForm::other_fields() const {
  std::set<std::string> wanted;
  if (is_plain())
    wanted = {"layout", "width", "way", "keep", "psnr", "seconds", "report", "page_size", "picture_size"};
  else if (format().name == FormatName().name)
    wanted = {"layout", "page_size"};
  else
    wanted = {"page_size"};
  std::vector<FieldInfo> fields = action_type<ExportAction>().fields();
  std::erase_if(fields, [&](const FieldInfo& field) { return !wanted.contains(field.name); });
  return fields;
}

ExportAction ExportForm::action(const Scene& scene, const std::vector<NodeRef>& nodes,
                                const std::filesystem::path& path) const {
  nlohmann::json action = nlohmann::json::object();
  // Values of hidden inputs do not count.
  std::set<std::string> shown{"format", "plain"};
  for (const FieldInfo& field : other_fields()) shown.insert(field.name);
  for (const auto& [name, value] : inputs_.values().items())
    if (shown.contains(name)) action[name] = value;
  action["out"] = path.string();
  for (const NodeRef& node : nodes) action["nodes"].push_back(static_cast<std::uint64_t>(node.id));
  return read_action<ExportAction>(action, scene);
}

void ExportForm::draw_format_choice() {
  const Format& chosen = format();
  ImGui::SetNextItemWidth(px(150));
  if (ImGui::BeginCombo("##format", chosen.title)) {
    for (const std::string& name : written_formats()) {
      const Format& offered = format_named(name);
      if (ImGui::Selectable(offered.title, &offered == &chosen)) {
        inputs_.set("format", offered.name);
        inputs_.set("plain", false);
      }
      announce::item("format " + name);
      ui::tip(offered.title, "", offered.help);
    }
    ImGui::EndCombo();
  }
  announce::item("format");
  ui::tip("Format", "", chosen.help);
}

void ExportForm::draw(ToolContext& editor, const std::vector<NodeRef>& nodes, const std::string& problem) {
  draw_format_choice();
  if (format().name == FormatName().name) {
    ImGui::SameLine();
    bool plain = is_plain();
    if (ui::toggle("One plain folder##plain", plain)) inputs_.set("plain", plain);
    ui::tip("One plain folder", "",
            "Merges all objects into one folder with one decoder that any MobileNeRF viewer can show.");
    if (plain) {
      ImGui::SameLine();
      if (ui::button("Compare...##compare")) preview_.begin(editor.view, editor.jobs, nodes);
      ui::tip("Compare...", "", "Compares decoders by error and frame time before the export.");
    }
  }
  ImGui::SameLine();
  options_.draw(editor, "Layout, texture size, and how one decoder is fitted.", other_fields(), inputs_, problem);
  if (is_plain()) ui::hint(choice_words());
}

void ExportForm::draw_comparison(Jobs& jobs) {
  const auto choice = preview_.draw(jobs);
  if (!choice) return;
  inputs_.set("way", Codec<FuseMethod>::write(choice->way));
  inputs_.set("width", choice->width);
}

bool ExportForm::close_popup(Jobs& jobs) { return options_.close() || preview_.leave(jobs); }

}  // namespace rebake
