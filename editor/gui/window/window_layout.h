#pragma once

#include <array>
#include <vector>

#include "editor/gui/panels/panels.h"
#include "editor/gui/view/viewport.h"
#include "editor/gui/window/commands.h"

namespace rebake {

/// Where everything in the window stands: menu, tools, the picture, panels beside and below it.
class WindowLayout {
 public:
  explicit WindowLayout(Desk& desk) : desk_(desk) {}
  /// All but dialogs. `moves`: what the pointer did since the last frame.
  void draw(Viewport& viewport, const std::vector<std::array<double, 2>>& moves);

 private:
  float side_width(const ImVec2& screen) const;
  void lay_out(const ImVec2& screen);
  void picture(const ImVec2& at, const ImVec2& size);
  void sides(const ImVec2& at, const ImVec2& size);
  void scope();
  void context_menu();
  void menu_item(const Command& command);
  void menu();
  void tool_bar();
  void tabs();
  void status();

  Desk& desk_;
  Viewport* viewport_ = nullptr;  ///< of this frame
  const std::vector<std::array<double, 2>>* moves_ = nullptr;
  OutlinePanel outline_;
  PropertiesPanel properties_;
  AdjustPanel adjust_;
  HistoryPanel history_;
  ViewsPanel views_;
  LightPanel light_;
  ScriptPanel script_;
  PalettePanel palette_;
  EditForm form_;
  float options_height_ = 0;  ///< that the tool's options took in the last frame
  float menu_height_ = 0;
  bool views_shown_ = false;              ///< in this frame
  ToolKind shown_tool_ = ToolKind::pick;  ///< that the tool bar was scrolled to
};

}  // namespace rebake
