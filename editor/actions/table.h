#pragma once

#include <variant>

#include "editor/actions/export.h"
#include "editor/actions/render.h"
#include "editor/actions/save.h"

namespace rebake {

/// The one table of actions: commands that read the scene and write files, never part of its history.
using Action = std::variant<RenderAction, ExportAction, SaveAction>;

}  // namespace rebake
