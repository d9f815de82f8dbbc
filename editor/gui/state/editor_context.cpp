#include "editor/gui/state/editor_context.h"

#include <algorithm>
#include <utility>

#include "editor/actions/views.h"
#include "editor/edits/nodes/import.h"
#include "editor/gui/state/navigation.h"

namespace rebake {

EditorContext::EditorContext(Settings with, const std::function<void()>& wake)
    : ToolContext(std::move(with), wake),
      relighter(wake),
      project(jobs.worker, settings, messages, now, [this] { view.camera = framing_camera(scene(), view.aspect()); }),
      training(jobs.worker, wake) {
  project.begin_journal();
}

void EditorContext::update() {
  if (take_news()) {
    if (std::all_of(now->done.begin(), now->done.end(), [](const Edit& one) { return one.is<Import>(); }))
      project.imported = scene();
    if (awaits_first_scene_ && !world_bounds(scene()).isEmpty()) {
      awaits_first_scene_ = false;
      view.camera = framing_camera(scene(), view.aspect());
    }
  }
  call_finished();
  take_training();
}

// The first look at a training is from its first photograph, if there is nothing else to see.
void EditorContext::take_training() {
  const std::optional<std::string> trained = training.update(messages);
  const bool appears = !beside && training.node();
  beside = training.node();
  if (appears && awaits_first_scene_) {
    awaits_first_scene_ = false;
    std::vector<std::string> notes;
    view.camera = views_of(training.cameras(), notes).front();
  }
  if (!trained) return;
  messages.say("Trained " + *trained + ".");
  dialogs.training = false;
  project.open({*trained});
}

void EditorContext::frame_view() {
  Box box;
  for (const PlacedNode& placed : placed_nodes(scene()))
    if (placed.visible && placed.node->selection) box.extend(selection_bounds(placed));
  view.camera = framed(view.camera, box.isEmpty() ? focus() : box, view.aspect());
}

}  // namespace rebake
