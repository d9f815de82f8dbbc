#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "editor/edits/nodes/import.h"
#include "editor/edits/nodes/unlock.h"
#include "editor/edits/scene_change.h"
#include "editor/edits/select/select.h"
#include "editor/edits/select/select_like.h"
#include "editor/edits/shape/erase.h"
#include "editor/edits/shape/separate.h"
#include "editor/edits/support.h"
#include "editor/fields/field_info.h"
#include "editor/gui/panels/panels.h"
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

const FieldInfo* field_named(const std::vector<FieldInfo>& fields, const char* name) {
  const auto found = std::find_if(fields.begin(), fields.end(), [&](const FieldInfo& one) { return one.name == name; });
  return found == fields.end() ? nullptr : &*found;
}

// Number of selected triangles in a scene or its preview: in the nodes of the scope, or in `only` and its descendants.
std::size_t selected_in(const DocumentEditor& editor, const Scene& scene, NodeId only) {
  // As selectable(): the hidden node itself counts if it is named.
  const auto counts = [&](const PlacedNode& placed) {
    if (only == NodeId::none) return editor.in_scope(scene, placed);
    if (placed.node->id == only) return !placed.locked;
    NodeId up = placed.node->id;
    while (up != NodeId::none && up != only) up = parent_of(scene, up);
    return up == only && placed.visible && !placed.locked;
  };
  std::size_t triangles = 0;
  for (const PlacedNode& placed : placed_nodes(scene))
    if (placed.node->selection && counts(placed)) triangles += count(*placed.node->selection);
  return triangles;
}

}  // namespace

void EditForm::begin(const DocumentEditor& editor, const std::string& op) {
  op_ = op;
  problem_.clear();
  previewed_.clear();
  request_ = 0;
  inputs_ = {};
  picks_ = {};
  document_ = editor.now->document;
  fill_picks(editor);
  for (const FieldInfo& field : type_named(op_)->fields()) {
    if (field.name == "selection" && editor.selected_triangles() > 0) inputs_.set("selection", true);
    if (field.required && field.type.kind == FieldKind::number) inputs_.set(field.name, 0);
  }
}

void EditForm::fill_picks(const DocumentEditor& editor) {
  json list = json::array();
  for (const NodeId id : editor.active_tops()) list.push_back(static_cast<std::uint64_t>(id));
  for (const FieldInfo& field : type_named(op_)->fields()) {
    if (field.type.kind != FieldKind::nodes || !field.required) continue;
    const json values = inputs_.values();
    const auto there = values.find(field.name);
    if (there == values.end() || *there == picks_) inputs_.set(field.name, list);
  }
  picks_ = std::move(list);
}

// One edit per node of the scope if the form has a node field without a choice, otherwise one edit. Throws EditError if
// the scope has no node for the edit.
std::vector<json> EditForm::lines(const DocumentEditor& editor) const {
  json line = inputs_.values();
  line["op"] = op_;
  const std::vector<FieldInfo> fields = type_named(op_)->fields();
  const FieldInfo* const node = field_named(fields, "node");
  if (node == nullptr || node->type.kind != FieldKind::node || line.contains("node") || line.contains("nodes"))
    return {line};
  // These take the one nearest triangle, or the mean of the selection, of all nodes together.
  if (line.contains("point") || line.contains("connected") || op_ == SelectLike::op) {
    if (editor.active.empty()) return {line};
    const std::vector<NodeId> tops = editor.active_tops();
    if (tops.size() > 1) throw EditError("several nodes are picked: pick one node or one group");
    if (editor.nodes_in_scope().empty()) throw EditError("there is no node to edit " + editor.scope_words());
    line["node"] = static_cast<std::uint64_t>(tops.front());
    return {line};
  }
  const bool takes_selection = field_named(fields, "selection") != nullptr;
  const bool selection = type_named(op_)->needs_selection || (takes_selection && line.value("selection", false));
  const auto with_node = [&](NodeId id) {
    json one = line;
    one["node"] = static_cast<std::uint64_t>(id);
    return one;
  };
  if (editor.active.empty()) {
    if (!node->required && (!takes_selection || selection)) return {line};
    if (selection) {
      std::vector<json> selected;
      for (const NodeId one : editor.nodes_in_scope(true)) selected.push_back(with_node(one));
      if (selected.empty()) throw EditError("nothing is selected");
      return selected;
    }
    // Nothing is picked, but the edit needs a node: the only visible object.
    std::vector<json> visible;
    for (const PlacedNode& placed : placed_nodes(editor.scene()))
      if (placed.visible && placed.node->object && (!placed.locked || op_ == Unlock::op))
        visible.push_back(with_node(placed.node->id));
    if (visible.empty()) throw EditError("the scene has no visible object");
    if (visible.size() > 1) throw EditError("nothing is picked: pick a node");
    return visible;
  }
  std::vector<json> result;
  if (node->required && !selection)
    for (const NodeId id : editor.active_tops()) result.push_back(with_node(id));
  else
    for (const std::optional<NodeRef>& one : editor.scope(selection)) result.push_back(with_node(one->id));
  // One edit for all nodes, so that texels which it uncovers stay.
  if (op_ == Erase::op && result.size() > 1) {
    for (const json& one : result) line["nodes"].push_back(one.at("node"));
    return {line};
  }
  // A stored selection need not exist in all of them.
  if (op_ == Select::op && line.contains("saved") && line.at("saved").is_string()) {
    std::vector<json> with_it = result;
    std::erase_if(with_it, [&](const json& one) {
      const NodePtr of = find(editor.scene(), NodeId(one.at("node").get<std::uint64_t>()));
      return !of->saved_selections.contains(line.at("saved").get<std::string>());
    });
    if (!with_it.empty()) return with_it;
  }
  if (result.empty())
    throw EditError((selection ? "nothing is selected " : "there is no node to edit ") + editor.scope_words());
  return result;
}

// Requests a preview of the edits. If a field is invalid, shows its error and waits.
void EditForm::show(DocumentEditor& editor) {
  if (editor.jobs.worker.busy()) return;
  // That of a drag comes first.
  const std::size_t shown = editor.requested_preview();
  if (shown != 0 && shown != request_) return;
  try {
    const std::vector<json> wanted = lines(editor);
    const Ground& ground = editor.scene().ground;
    const std::string text =
        json(wanted).dump() + fmt::format(" {} {} {}", ground.normal.x(), ground.normal.z(), ground.height);
    if (text == previewed_ && previewed_on_ == editor.scene().roots && previewed_with_ == editor.scene().views &&
        shown == request_)
      return;
    std::vector<Edit> edits;
    for (const json& line : wanted) edits.push_back(read_edit(line, editor.scene()));
    previewed_ = text;
    previewed_on_ = editor.scene().roots;
    previewed_with_ = editor.scene().views;
    // Imports have no preview: their files would be read twice.
    if (edits.front().is<Import>()) {
      request_ = 0;
      return;
    }
    request_ = editor.show_preview(std::move(edits));
    problem_.clear();
  } catch (const Error& error) {
    previewed_.clear();
    problem_ = error.what();
  }
}

// For selecting edits: draws the number of triangles that would be selected, counted in the preview.
void EditForm::draw_count(const DocumentEditor& editor) const {
  if (!type_named(op_)->selects || !previews_ || !problem_.empty()) return;
  const bool there =
      editor.preview && editor.preview->of == editor.scene().roots && editor.preview->request == request_;
  std::string text = "Counting...";
  const json values = inputs_.values();
  const auto node = values.find("node");
  const NodeId only =
      node != values.end() && node->is_number_unsigned() ? NodeId(node->get<std::uint64_t>()) : NodeId::none;
  if (only != NodeId::none && !find(editor.scene(), only)) return;
  if (there)
    text =
        fmt::format("Would select {} (currently {})", triangles_text(selected_in(editor, editor.preview->scene, only)),
                    selected_in(editor, editor.scene(), only));
  // The preview is that of earlier fields.
  if (const std::string problem = editor.previews.problem();
      !editor.previews.busy() && !problem.empty() && editor.requested_preview() == request_)
    text = problem;
  ImGui::TextUnformatted(text.c_str());
  announce::item("count: " + text);
}

void EditForm::draw(DocumentEditor& editor, DialogState& dialogs, float right) {
  if (dialogs.form.empty()) {
    // Show the preview until the applied edit is done.
    if (!op_.empty() && editor.at_rest()) editor.drop_preview();
    op_.clear();
    return;
  }
  // Nodes of another document have the same numbers.
  if (op_ != dialogs.form || document_ != editor.now->document) {
    // That of the form before.
    if (request_ != 0 && editor.requested_preview() == request_) editor.drop_preview();
    begin(editor, dialogs.form);
  }
  fill_picks(editor);
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
  inputs_.draw(editor, fields, problem_);
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
  if (!open) dialogs.form.clear();
}

}  // namespace rebake
