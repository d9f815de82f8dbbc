#pragma once

#include <functional>

#include "editor/gui/state/dialog_state.h"
#include "editor/gui/state/document_files.h"
#include "editor/gui/state/relighter.h"
#include "editor/gui/state/tool_context.h"
#include "editor/gui/state/training_job.h"

namespace rebake {

/// The whole state of the window apart from the document. Functions take the part that they need: DocumentEditor,
/// ToolContext, or a member.
struct EditorContext : ToolContext {
  /// `wake` makes the window draw a frame; it is called from other threads.
  EditorContext(Settings with, const std::function<void()>& wake);

  DialogState dialogs;
  Relighter relighter;
  Project project;
  TrainingJob training;

  /// Fetches snapshot, messages and finished callbacks from the worker, and the latest preview. Call once per frame.
  void update();
  /// Frames the selected triangles, else the picked nodes, else everything visible.
  void frame_view();

 private:
  void take_training();
  bool awaits_first_scene_ = true;  ///< no scene was shown yet: the first one is to be framed
};

}  // namespace rebake
