#pragma once

#include <utility>

#include "editor/gui/state/document_editor.h"
#include "editor/gui/state/settings.h"
#include "editor/gui/state/tool_state.h"
#include "editor/gui/state/view_state.h"

namespace rebake {

/// What tools work with: the document, the view and the options of tools.
struct ToolContext : DocumentEditor {
  ToolContext(Settings with, const std::function<void()>& wake) : DocumentEditor(wake), settings(std::move(with)) {}

  Settings settings;
  ViewState view;
  ToolState tools;
};

}  // namespace rebake
