#pragma once

#include <variant>

#include "editor/actions/export.h"
#include "editor/actions/redo.h"
#include "editor/actions/render.h"
#include "editor/actions/save.h"
#include "editor/actions/save_project.h"
#include "editor/actions/undo.h"

namespace rebake {

/// The one table of actions: commands that write files or walk through history, never part of it.
using Action = std::variant<RenderAction, ExportAction, SaveAction, SaveProjectAction, UndoAction, RedoAction>;

}  // namespace rebake
