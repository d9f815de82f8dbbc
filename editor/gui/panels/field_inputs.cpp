#include "editor/gui/panels/field_inputs.h"

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <cmath>

#include "editor/edits/support.h"
#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/expression.h"
#include "editor/gui/ui/widgets.h"

namespace rebake {

using nlohmann::json;

namespace {

void draw_flag(const FieldInfo& field, json& values) {
  const char* name = field.name.c_str();
  bool value = values.contains(name) ? values[name].get<bool>() : field.initial == "true";
  if (ui::toggle("##value", value)) values[name] = value;
}

void draw_node_choice(const DocumentEditor& editor, const FieldInfo& field, json& values) {
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
  if (ImGui::BeginCombo("##value", chosen.empty() ? "(default)" : chosen.c_str())) {
    if (!field.required && initial.empty() && ImGui::Selectable("(default)", chosen.empty())) values.erase(name);
    for (const std::string& word : field.type.choices) {
      if (ImGui::Selectable(word.c_str(), word == chosen)) values[name] = word;
      announce::item(fmt::format("{} {}", field.name, word));
    }
    ImGui::EndCombo();
  }
}

// A text field for a value that may be an expression or JSON. `text`: the text as typed.
void draw_text(const FieldInfo& field, std::string& text, json& values) {
  const char* name = field.name.c_str();
  // The default; that of a text without its quotes.
  std::string hint = field.initial.empty() ? field.type.words : field.initial;
  if (hint.size() > 1 && hint.starts_with('"')) hint = hint.substr(1, hint.size() - 2);
  if (ImGui::InputTextWithHint("##value", hint.c_str(), &text)) {
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
      // Text that is not JSON stays a string; reading the field reports the error.
      const json read = json::parse(text, nullptr, false);
      values[name] = read.is_discarded() ? json(text) : read;
    }
  }
}

}  // namespace

void FieldInputs::set(const std::string& field, const json& value) {
  values_[field] = value;
  texts_[field] = value.is_string() ? value.get<std::string>() : value.dump();
}

void FieldInputs::draw(const DocumentEditor& editor, const std::vector<FieldInfo>& fields, const std::string& problem) {
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
    if (problem.find("\"" + field.name + "\"") != std::string::npos) ui::wrapped(problem, theme().danger);
    ImGui::PopID();
  }
}

}  // namespace rebake
