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
#include "editor/fields/field_info.h"
#include "editor/gui/panels/panels.h"
#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/expression.h"
#include "editor/gui/ui/widgets.h"

namespace rebake {

using nlohmann::json;

namespace {

const EditType* type_named(const std::string& op) {
  for (const EditType* type : edit_types())
    if (op == type->op) return type;
  return nullptr;
}

const FieldInfo* field_named(const std::vector<FieldInfo>& fields, const char* name) {
  const auto found = std::find_if(fields.begin(), fields.end(), [&](const FieldInfo& one) { return one.name == name; });
  return found == fields.end() ? nullptr : &*found;
}

std::size_t selected_in(const Scene& scene) {
  std::size_t triangles = 0;
  for (const PlacedNode& placed : placed_nodes(scene))
    if (placed.node->selection) triangles += count(*placed.node->selection);
  return triangles;
}

}  // namespace

void EditForm::begin(const EditorContext& editor) {
  op_ = editor.dialogs.form;
  problem_.clear();
  previewed_.clear();
  values_ = json::object();
  texts_.clear();
  for (const FieldInfo& field : type_named(op_)->fields()) {
    if (field.type.kind == FieldKind::nodes && field.required) {
      json list = json::array();
      for (const NodeId id : editor.active_tops()) list.push_back(static_cast<std::uint64_t>(id));
      values_[field.name] = list;
      texts_[field.name] = list.dump();
    }
    if (field.name == "selection" && editor.selected_triangles() > 0) values_["selection"] = true;
    if (field.required && field.type.kind == FieldKind::number) values_[field.name] = 0;
  }
}

// One edit per node of the scope if the form has a node field without a choice, otherwise one edit. Throws EditError if
// the scope has no node for the edit.
std::vector<json> EditForm::lines(const EditorContext& editor) const {
  json line = values_;
  line["op"] = op_;
  const std::vector<FieldInfo> fields = type_named(op_)->fields();
  const FieldInfo* const node = field_named(fields, "node");
  if (node == nullptr || node->type.kind != FieldKind::node || values_.contains("node")) return {line};
  const bool deforms = field_named(fields, "selection") != nullptr;
  const bool selection = type_named(op_)->needs_selection || (deforms && values_.value("selection", false));
  const auto with_node = [&](NodeId id) {
    json one = line;
    one["node"] = static_cast<std::uint64_t>(id);
    return one;
  };
  if (editor.active.empty()) {
    if (!node->required && (!deforms || selection)) return {line};
    // Nothing is picked, but the edit needs a node: use the first visible object.
    for (const PlacedNode& placed : placed_nodes(editor.scene()))
      if (placed.visible && placed.node->object) return {with_node(placed.node->id)};
    throw EditError("the scene has no visible object");
  }
  std::vector<json> result;
  if (node->required && !selection)
    for (const NodeId id : editor.active_tops()) result.push_back(with_node(id));
  else
    for (const std::optional<NodeRef>& one : editor.scope(selection)) result.push_back(with_node(one->id));
  if (result.empty())
    throw EditError((selection ? "nothing is selected " : "there is no node to edit ") + editor.scope_words());
  return result;
}

// Requests a preview of the edits. If a field is invalid, shows its error and waits.
void EditForm::show(EditorContext& editor) {
  if (editor.jobs.worker.busy()) return;
  try {
    const std::vector<json> wanted = lines(editor);
    const Ground& ground = editor.scene().ground;
    const std::string text =
        json(wanted).dump() + fmt::format(" {} {} {}", ground.normal.x(), ground.normal.z(), ground.height);
    if (text == previewed_ && previewed_on_ == editor.scene().roots) return;
    previewed_ = text;
    previewed_on_ = editor.scene().roots;
    std::vector<Edit> edits;
    for (const json& line : wanted) edits.push_back(read_edit(line, editor.scene()));
    // Imports have no preview: their files would be read twice.
    if (edits.front().is<Import>()) return;
    editor.show_preview(std::move(edits));
    problem_.clear();
  } catch (const Error& error) {
    previewed_.clear();
    problem_ = error.what();
  }
}

// For selecting edits: draws the number of triangles that would be selected, counted in the preview.
void EditForm::draw_count(const EditorContext& editor) const {
  if (!type_named(op_)->selects || !previews_ || !problem_.empty()) return;
  const bool there = editor.preview && editor.preview->of == editor.scene().roots;
  std::string text = "Counting...";
  if (there)
    text = fmt::format("Would select {} triangles (currently {})", selected_in(editor.preview->scene),
                       selected_in(editor.scene()));
  ImGui::TextUnformatted(text.c_str());
  announce::item("count: " + text);
}

namespace {

void draw_flag(const FieldInfo& field, json& values) {
  const char* name = field.name.c_str();
  bool value = values.contains(name) ? values[name].get<bool>() : field.initial == "true";
  if (ui::toggle("##value", value)) values[name] = value;
}

void draw_node_choice(const EditorContext& editor, const FieldInfo& field, json& values) {
  const char* name = field.name.c_str();
  const std::uint64_t chosen = values.value(name, std::uint64_t{0});
  const NodePtr node = find(editor.scene(), static_cast<NodeId>(chosen));
  const std::string scope = field.name == "node" ? "Scope: " + editor.scope_words() : "(none)";
  if (ImGui::BeginCombo("##value", node ? node->name.c_str() : scope.c_str())) {
    if ((!field.required || field.name == "node") && ImGui::Selectable(scope.c_str(), chosen == 0)) values.erase(name);
    for (const PlacedNode& placed : placed_nodes(editor.scene()))
      if (ImGui::Selectable(placed.node->name.c_str(), placed.node->id == static_cast<NodeId>(chosen)))
        values[name] = static_cast<std::uint64_t>(placed.node->id);
    ImGui::EndCombo();
  }
}

void draw_choice(const FieldInfo& field, json& values) {
  const char* name = field.name.c_str();
  const std::string initial = field.initial.size() > 2 ? field.initial.substr(1, field.initial.size() - 2) : "";
  const std::string chosen = values.value(name, initial);
  if (ImGui::BeginCombo("##value", chosen.c_str())) {
    for (const std::string& word : field.type.choices)
      if (ImGui::Selectable(word.c_str(), word == chosen)) values[name] = word;
    ImGui::EndCombo();
  }
}

// A text field for a value that may be an expression or JSON. `text`: the text as typed.
void draw_text(const FieldInfo& field, std::string& text, json& values) {
  const char* name = field.name.c_str();
  if (ImGui::InputTextWithHint("##value", field.initial.empty() ? field.type.words.c_str() : field.initial.c_str(),
                               &text)) {
    if (text.empty()) {
      values.erase(name);
    } else if (field.type.kind == FieldKind::text) {
      values[name] = text;
    } else if (const auto number = evaluated(text); number) {
      values[name] =
          field.type.kind == FieldKind::whole_number && std::abs(*number) < 1e15 && *number == std::round(*number)
              ? json(static_cast<std::int64_t>(*number))
              : json(*number);
    } else {
      // Text that is not JSON stays a string; read_edit() reports the error.
      const json read = json::parse(text, nullptr, false);
      values[name] = read.is_discarded() ? json(text) : read;
    }
  }
}

}  // namespace

// Draws a labelled input for each field.
void EditForm::draw_fields(const EditorContext& editor, const std::vector<FieldInfo>& fields) {
  for (const FieldInfo& field : fields) {
    ImGui::PushID(field.name.c_str());
    const std::string words = words_of(field.name);
    ui::label(words.c_str());
    switch (field.type.kind) {
      case FieldKind::flag:
        draw_flag(field, values_);
        break;
      case FieldKind::node:
        draw_node_choice(editor, field, values_);
        break;
      case FieldKind::choice:
        draw_choice(field, values_);
        break;
      default:
        draw_text(field, texts_[field.name], values_);
    }
    announce::item(field.name);
    ui::tip(words, field.required ? "needed" : "", field.help + " (" + notation_of(field) + ")");
    if (problem_.find("\"" + field.name + "\"") != std::string::npos) ui::wrapped(problem_, theme().danger);
    ImGui::PopID();
  }
}

void EditForm::draw(EditorContext& editor, float right) {
  if (editor.dialogs.form.empty()) {
    // Show the preview until the applied edit is done.
    if (!op_.empty() && editor.at_rest()) editor.drop_preview();
    op_.clear();
    return;
  }
  if (op_ != editor.dialogs.form) begin(editor);
  bool open = true;
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  // At the viewport's top right corner, so that it does not cover the outliner, which sets the scope.
  ImGui::SetNextWindowPos({right - px(10), px(40)}, ImGuiCond_Appearing, {1, 0});
  // The height follows the content, so that no button is cut off.
  ImGui::SetNextWindowSizeConstraints({px(440), 0}, {px(440), screen.y - px(60)});
  ImGui::Begin((words_of(op_) + "###form").c_str(), &open,
               ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_AlwaysAutoResize);
  const announce::Part part("form");
  const std::vector<FieldInfo> fields = type_named(op_)->fields();
  ui::muted(type_named(op_)->help);
  draw_fields(editor, fields);
  const bool said = std::any_of(fields.begin(), fields.end(), [&](const FieldInfo& field) {
    return problem_.find("\"" + field.name + "\"") != std::string::npos;
  });
  if (!problem_.empty() && !said) ui::wrapped(problem_, theme().danger);
  if (previews_) show(editor);
  draw_count(editor);
  if (ui::primary_button("Apply##apply")) {
    try {
      std::vector<Edit> edits;
      for (const json& line : lines(editor)) edits.push_back(read_edit(line, editor.scene()));
      editor.edits(edits);
      problem_.clear();
      open = false;
    } catch (const Error& error) {
      problem_ = error.what();
    }
  }
  ImGui::SameLine();
  if (ui::button("Close")) open = false;
  ImGui::SameLine();
  if (ui::toggle("Preview", previews_) && !previews_) editor.drop_preview();
  ImGui::End();
  if (!open) editor.dialogs.form.clear();
}

}  // namespace rebake
