#include "editor/gui/panels/light_model_form.h"

#include <imgui.h>

#include "editor/actions/forget_light_model.h"
#include "editor/actions/train_light.h"
#include "editor/actions/use_light_model.h"
#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/widgets.h"
#include "mesh_ops/base/error.h"

namespace rebake {

namespace {

// The object that buttons work on: the one that tools would deform.
std::optional<NodeRef> node_of(const EditorContext& editor) {
  const std::set<NodeId> nodes = editor.deform_nodes();
  if (nodes.size() != 1) return std::nullopt;
  return NodeRef{*nodes.begin()};
}

template <class T>
void start(EditorContext& editor, const char* title, const T& action) {
  editor.jobs.worker.start(
      title, [action](Session& session) { run(session, action); }, [&editor] { editor.relighter.forget_request(); });
}

}  // namespace

void use_light_model_of(EditorContext& editor, const std::string& file) {
  start(editor, "use light model", UseLightModelAction{file});
}

void LightModelForm::train(EditorContext& editor) {
  problem_.clear();
  try {
    auto action = read_action<TrainLightAction>(inputs_.values(), editor.scene());
    if (!action.node) action.node = node_of(editor);
    start(editor, "train light model", action);
  } catch (const Error& error) {
    problem_ = error.what();
  }
}

void LightModelForm::forget(EditorContext& editor) {
  start(editor, "forget light model", ForgetLightModelAction{node_of(editor)});
}

void LightModelForm::draw(EditorContext& editor) {
  const announce::Part part("model");
  ui::label("Drag model");
  ImGui::BeginDisabled(editor.jobs.worker.busy());
  if (ui::button("Train##train")) train(editor);
  ui::tip("Train", "",
          "Trains a light model for the picked object from its deformations in the history. Drags then use it if it is "
          "better than rotated light. Esc cancels.");
  ImGui::SameLine();
  if (ui::button("Load...##load")) editor.dialogs.path = FileDialogPurpose::light_model;
  ui::tip("Load...", "", "Makes drags use a trained model from a file.");
  ImGui::SameLine();
  if (ui::button("Forget##forget")) forget(editor);
  ui::tip("Forget", "", "Makes drags of the picked object use rotated light again.");
  ImGui::EndDisabled();
  ImGui::SameLine();
  options_.draw(editor, "Kind of model, poses, rays, and a file for it.", action_type<TrainLightAction>().fields(),
                inputs_, problem_);
  if (ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape), false)) options_.close();
  if (!problem_.empty()) ui::wrapped(problem_, theme().danger);
}

}  // namespace rebake
