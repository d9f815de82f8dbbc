#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <nlohmann/json.hpp>

#include "editor/edits/nodes/import.h"
#include "editor/edits/shape/separate.h"
#include "editor/edits/support.h"
#include "editor/fields/field_line.h"
#include "editor/gui/panels/panels.h"
#include "editor/gui/tools/expression.h"
#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/widgets.h"

namespace rebake {

using nlohmann::json;

namespace {

const EditType* type_named(const std::string& op) {
  for (const EditType* type : edit_types())
    if (op == type->op) return type;
  return nullptr;
}

bool needs_selection(const std::string& op) {
  for (const char* one : {Grow::op, Shrink::op, SelectConnected::op, DeleteSelected::op, Separate::op})
    if (op == one) return true;
  return false;
}

const FieldLine* field_named(const std::vector<FieldLine>& fields, const char* name) {
  const auto found = std::find_if(fields.begin(), fields.end(), [&](const FieldLine& one) { return one.name == name; });
  return found == fields.end() ? nullptr : &*found;
}

std::size_t selected_in(const Scene& scene) {
  std::size_t triangles = 0;
  for (const PlacedNode& placed : placed_nodes(scene))
    if (placed.node->selection) triangles += count(*placed.node->selection);
  return triangles;
}

}  // namespace

void EditForm::begin(const Desk& desk) {
  op_ = desk.asking.form;
  problem_.clear();
  previewed_.clear();
  values_ = json::object();
  texts_.clear();
  for (const FieldLine& field : type_named(op_)->fields()) {
    if (field.type.kind == FieldKind::nodes && field.required) {
      json list = json::array();
      for (const NodeId id : desk.active_tops()) list.push_back(static_cast<std::uint64_t>(id));
      values_[field.name] = list;
      texts_[field.name] = list.dump();
    }
    if (field.name == "selection" && desk.selected_triangles() > 0) values_["selection"] = true;
    if (field.required && field.type.kind == FieldKind::number) values_[field.name] = 0;
  }
}

// One edit per node of the scope if the form has a node field without a choice, otherwise one edit. Throws EditError if
// the scope has no node for the edit.
std::vector<json> EditForm::lines(const Desk& desk) const {
  json line = values_;
  line["op"] = op_;
  const std::vector<FieldLine> fields = type_named(op_)->fields();
  const FieldLine* const node = field_named(fields, "node");
  if (node == nullptr || node->type.kind != FieldKind::node || values_.contains("node")) return {line};
  const bool deforms = field_named(fields, "selection") != nullptr;
  const bool selection = needs_selection(op_) || (deforms && values_.value("selection", false));
  const auto with_node = [&](NodeId id) {
    json one = line;
    one["node"] = static_cast<std::uint64_t>(id);
    return one;
  };
  if (desk.active.empty()) {
    if (!node->required && (!deforms || selection)) return {line};
    // Nothing is picked, but the edit needs a node: use the first visible object.
    for (const PlacedNode& placed : placed_nodes(desk.scene()))
      if (placed.visible && placed.node->object) return {with_node(placed.node->id)};
    throw EditError("the scene has no visible object");
  }
  std::vector<json> result;
  if (node->required && !selection)
    for (const NodeId id : desk.active_tops()) result.push_back(with_node(id));
  else
    for (const std::optional<NodeRef>& one : desk.scope(selection)) result.push_back(with_node(one->id));
  if (result.empty())
    throw EditError((selection ? "nothing is selected " : "nothing can be edited ") + desk.scope_words());
  return result;
}

// Requests a preview of the edits. If a field is invalid, shows its error and waits.
void EditForm::show(Desk& desk) {
  if (desk.jobs.worker.busy()) return;
  try {
    const std::vector<json> wanted = lines(desk);
    const Ground& ground = desk.scene().ground;
    const std::string text =
        json(wanted).dump() + fmt::format(" {} {} {}", ground.normal.x(), ground.normal.z(), ground.height);
    if (text == previewed_ && previewed_on_ == desk.scene().roots) return;
    previewed_ = text;
    previewed_on_ = desk.scene().roots;
    std::vector<Edit> edits;
    for (const json& line : wanted) edits.push_back(read_edit(line, desk.scene()));
    // Imports have no preview: their files would be read twice.
    if (edits.front().is<Import>()) return;
    desk.show_preview(std::move(edits));
    problem_.clear();
  } catch (const Error& error) {
    previewed_.clear();
    problem_ = error.what();
  }
}

// For selecting edits: draws the number of triangles that would be selected, counted in the preview.
void EditForm::draw_count(const Desk& desk) const {
  if (!type_named(op_)->selects || !previews_ || !problem_.empty()) return;
  const bool there = desk.preview && desk.preview->of == desk.scene().roots;
  std::string text = "Counting...";
  if (there)
    text = fmt::format("{} triangles selected (now {})", selected_in(desk.preview->scene), selected_in(desk.scene()));
  ImGui::TextUnformatted(text.c_str());
  announce::item("count: " + text);
}

void EditForm::draw(Desk& desk, float right) {
  if (desk.asking.form.empty()) {
    // Show the preview until the applied edit is done.
    if (!op_.empty() && desk.at_rest()) desk.drop_preview();
    op_.clear();
    return;
  }
  if (op_ != desk.asking.form) begin(desk);
  bool open = true;
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  // At the viewport's top right corner, so that it does not cover the outliner, which sets the scope.
  ImGui::SetNextWindowPos({right - px(10), px(40)}, ImGuiCond_Appearing, {1, 0});
  // The height follows the content, so that no button is cut off.
  ImGui::SetNextWindowSizeConstraints({px(440), 0}, {px(440), screen.y - px(60)});
  std::string title = op_;
  std::replace(title.begin(), title.end(), '_', ' ');
  title[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(title[0])));
  ImGui::Begin((title + "###form").c_str(), &open, ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_AlwaysAutoResize);
  const announce::Part part("form");
  const std::vector<FieldLine> fields = type_named(op_)->fields();
  ui::muted(type_named(op_)->help);
  for (const FieldLine& field : fields) {
    ImGui::PushID(field.name.c_str());
    const char* name = field.name.c_str();
    std::string words = field.name;
    std::replace(words.begin(), words.end(), '_', ' ');
    words[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(words[0])));
    ui::label(words.c_str());
    if (field.type.kind == FieldKind::flag) {
      bool value = values_.contains(name) ? values_[name].get<bool>() : field.initial == "true";
      if (ui::toggle("##value", value)) values_[name] = value;
    } else if (field.type.kind == FieldKind::node) {
      const std::uint64_t chosen = values_.value(name, std::uint64_t{0});
      const NodePtr node = find(desk.scene(), static_cast<NodeId>(chosen));
      const std::string scope = field.name == "node" ? "Scope: " + desk.scope_words() : "(none)";
      if (ImGui::BeginCombo("##value", node ? node->name.c_str() : scope.c_str())) {
        if ((!field.required || field.name == "node") && ImGui::Selectable(scope.c_str(), chosen == 0))
          values_.erase(name);
        for (const PlacedNode& placed : placed_nodes(desk.scene()))
          if (ImGui::Selectable(placed.node->name.c_str(), placed.node->id == static_cast<NodeId>(chosen)))
            values_[name] = static_cast<std::uint64_t>(placed.node->id);
        ImGui::EndCombo();
      }
    } else if (field.type.kind == FieldKind::choice) {
      const std::string initial = field.initial.size() > 2 ? field.initial.substr(1, field.initial.size() - 2) : "";
      const std::string chosen = values_.value(name, initial);
      if (ImGui::BeginCombo("##value", chosen.c_str())) {
        for (const std::string& word : field.type.choices)
          if (ImGui::Selectable(word.c_str(), word == chosen)) values_[name] = word;
        ImGui::EndCombo();
      }
    } else {
      std::string& text = texts_[name];
      if (ImGui::InputTextWithHint("##value", field.initial.empty() ? field.type.words.c_str() : field.initial.c_str(),
                                   &text)) {
        if (text.empty()) {
          values_.erase(name);
        } else if (field.type.kind == FieldKind::text) {
          values_[name] = text;
        } else if (const auto number = evaluated(text); number) {
          values_[name] =
              field.type.kind == FieldKind::whole_number && std::abs(*number) < 1e15 && *number == std::round(*number)
                  ? json(static_cast<std::int64_t>(*number))
                  : json(*number);
        } else {
          // Text that is not JSON stays a string; read_edit() reports the error.
          const json read = json::parse(text, nullptr, false);
          values_[name] = read.is_discarded() ? json(text) : read;
        }
      }
    }
    announce::item(field.name);
    ui::tip(words, field.required ? "needed" : "", field.help + " (" + words_of(field) + ")");
    if (problem_.find("\"" + field.name + "\"") != std::string::npos) ui::wrapped(problem_, theme().danger);
    ImGui::PopID();
  }
  const bool said = std::any_of(fields.begin(), fields.end(), [&](const FieldLine& field) {
    return problem_.find("\"" + field.name + "\"") != std::string::npos;
  });
  if (!problem_.empty() && !said) ui::wrapped(problem_, theme().danger);
  if (previews_) show(desk);
  draw_count(desk);
  if (ui::primary_button("Apply")) {
    try {
      std::vector<Edit> edits;
      for (const json& line : lines(desk)) edits.push_back(read_edit(line, desk.scene()));
      desk.edits(edits);
      problem_.clear();
      open = false;
    } catch (const Error& error) {
      problem_ = error.what();
    }
  }
  ImGui::SameLine();
  if (ui::button("Close")) open = false;
  ImGui::SameLine();
  if (ui::toggle("Preview", previews_) && !previews_) desk.drop_preview();
  ImGui::End();
  if (!open) desk.asking.form.clear();
}

}  // namespace rebake
