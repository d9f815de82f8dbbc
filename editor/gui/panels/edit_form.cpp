#include <imgui.h>
#include <imgui_stdlib.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "editor/edits/nodes/import.h"
#include "editor/fields/field_line.h"
#include "editor/gui/panels/panels.h"
#include "editor/gui/tools/expression.h"

namespace rebake {

using nlohmann::json;

namespace {

const EditType* type_named(const std::string& op) {
  for (const EditType* type : edit_types())
    if (op == type->op) return type;
  return nullptr;
}

}  // namespace

void EditForm::begin(const Desk& desk) {
  op_ = desk.asking.form;
  problem_.clear();
  previewed_.clear();
  values_ = json::object();
  texts_.clear();
  for (const FieldLine& field : type_named(op_)->fields()) {
    // What people have picked is what they mean; with nothing picked or selected, the first object.
    if (field.name == "node" && desk.selected_triangles() == 0)
      for (const PlacedNode& placed : placed_nodes(desk.scene()))
        if (placed.visible && placed.node->object && (desk.active.empty() || desk.active.contains(placed.node->id))) {
          values_["node"] = static_cast<std::uint64_t>(placed.node->id);
          break;
        }
    if (field.name == "selection" && desk.selected_triangles() > 0) values_["selection"] = true;
    if (field.required && field.type.kind == FieldKind::number) values_[field.name] = 0;
  }
}

// Has the worker make what the fields say, to be seen before it is applied; half-typed fields wait.
void EditForm::show(Desk& desk) {
  json line = values_;
  line["op"] = op_;
  const bool same = line.dump() == previewed_ && previewed_on_ == desk.scene().roots;
  if (same || desk.jobs.worker.busy() || ImGui::IsAnyMouseDown()) return;
  previewed_ = line.dump();
  previewed_on_ = desk.scene().roots;
  try {
    const Edit edit = read_edit(line, desk.scene());
    // Only what changes the picture: an import would be read twice.
    if (edit.is<Import>()) return;
    auto made = std::make_shared<std::optional<Desk::Preview>>();
    desk.jobs.worker.start(
        "preview",
        [edit, made](Session& session) {
          try {
            *made = Desk::Preview{rebake::apply(session.scene(), edit, session.progress).scene, session.scene().roots};
          } catch (const Error&) {
            made->reset();  // said when it is applied; or stopped
          }
        },
        [&desk, made, op = op_] {
          if (desk.asking.form == op) desk.preview = std::move(*made);
        });
    problem_.clear();
  } catch (const Error& error) {
    problem_ = error.what();
  }
}

void EditForm::draw(Desk& desk) {
  if (desk.asking.form.empty()) {
    if (!op_.empty()) desk.preview.reset();
    op_.clear();
    return;
  }
  if (op_ != desk.asking.form) begin(desk);
  bool open = true;
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  // Beside the picture, so that what the edit does can be seen.
  ImGui::SetNextWindowPos({screen.x - 10, 40}, ImGuiCond_Appearing, {1, 0});
  // As high as what it says, so that no button is cut off.
  ImGui::SetNextWindowSizeConstraints({420, 0}, {420, screen.y - 60});
  ImGui::Begin((op_ + "###form").c_str(), &open, ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_AlwaysAutoResize);
  const std::vector<FieldLine> fields = type_named(op_)->fields();
  ImGui::TextWrapped("%s", type_named(op_)->help);
  for (const FieldLine& field : fields) {
    ImGui::PushID(field.name.c_str());
    const char* name = field.name.c_str();
    ImGui::SetNextItemWidth(230);
    if (field.type.kind == FieldKind::flag) {
      bool value = values_.contains(name) ? values_[name].get<bool>() : field.initial == "true";
      if (ImGui::Checkbox(name, &value)) values_[name] = value;
    } else if (field.type.kind == FieldKind::node) {
      const std::uint64_t chosen = values_.value(name, std::uint64_t{0});
      const NodePtr node = find(desk.scene(), static_cast<NodeId>(chosen));
      if (ImGui::BeginCombo(name, node ? node->name.c_str() : "")) {
        if (!field.required && ImGui::Selectable("(none)", chosen == 0)) values_.erase(name);
        for (const PlacedNode& placed : placed_nodes(desk.scene()))
          if (ImGui::Selectable(placed.node->name.c_str(), placed.node->id == static_cast<NodeId>(chosen)))
            values_[name] = static_cast<std::uint64_t>(placed.node->id);
        ImGui::EndCombo();
      }
    } else if (field.type.kind == FieldKind::choice) {
      const std::string initial = field.initial.size() > 2 ? field.initial.substr(1, field.initial.size() - 2) : "";
      const std::string chosen = values_.value(name, initial);
      if (ImGui::BeginCombo(name, chosen.c_str())) {
        for (const std::string& word : field.type.choices)
          if (ImGui::Selectable(word.c_str(), word == chosen)) values_[name] = word;
        ImGui::EndCombo();
      }
    } else {
      std::string& text = texts_[name];
      if (ImGui::InputTextWithHint(name, field.initial.empty() ? field.type.words.c_str() : field.initial.c_str(),
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
          // Read when it is applied, so that what is half typed is no error yet.
          const json read = json::parse(text, nullptr, false);
          values_[name] = read.is_discarded() ? json(text) : read;
        }
      }
    }
    if (ImGui::IsItemHovered())
      ImGui::SetTooltip("%s%s\n%s", field.help.c_str(), field.required ? " (needed)" : "", words_of(field).c_str());
    if (problem_.find("\"" + field.name + "\"") != std::string::npos)
      ImGui::TextColored({1, 0.5F, 0.4F, 1}, "%s", problem_.c_str());
    ImGui::PopID();
  }
  const bool said = std::any_of(fields.begin(), fields.end(), [&](const FieldLine& field) {
    return problem_.find("\"" + field.name + "\"") != std::string::npos;
  });
  if (!problem_.empty() && !said) ImGui::TextColored({1, 0.5F, 0.4F, 1}, "%s", problem_.c_str());
  if (previews_) show(desk);
  if (ImGui::Button("Apply")) {
    try {
      json line = values_;
      line["op"] = op_;
      desk.edit(read_edit(line, desk.scene()));
      problem_.clear();
      open = false;
    } catch (const Error& error) {
      problem_ = error.what();
    }
  }
  ImGui::SameLine();
  if (ImGui::Button("Close")) open = false;
  ImGui::SameLine();
  if (ImGui::Checkbox("preview", &previews_) && !previews_) desk.preview.reset();
  ImGui::End();
  if (!open) desk.asking.form.clear();
}

}  // namespace rebake
