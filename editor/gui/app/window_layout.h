#pragma once

#include <array>
#include <vector>

#include "editor/gui/app/viewport.h"
#include "editor/gui/panels/panels.h"
#include "editor/gui/panels/training_form.h"
#include "editor/gui/state/commands.h"

namespace rebake {

/// Layout of the window: menu, tool bar, tool options, viewport, side and bottom panels, status bar.
class WindowLayout {
 public:
  explicit WindowLayout(EditorContext& editor) : editor_(editor) {}
  /// Draws everything except dialogs. `moves`: pointer positions since the last frame, in window pixels.
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

  EditorContext& editor_;
  Viewport* viewport_ = nullptr;  ///< argument of the current draw()
  const std::vector<std::array<double, 2>>* moves_ = nullptr;
  OutlinerPanel outline_;
  PropertiesPanel properties_;
  AdjustPanel adjust_;
  HistoryPanel history_;
  ViewsPanel views_;
  LightPanel light_;
  ScriptPanel script_;
  PalettePanel palette_;
  EditForm form_;
  TrainingForm training_;
  float options_height_ = 0;              ///< height of the tool options in the last frame, in pixels
  float menu_height_ = 0;                 ///< height of the menu bar, in pixels
  bool views_shown_ = false;              ///< the views panel was drawn in this frame
  ToolKind shown_tool_ = ToolKind::pick;  ///< the tool that the tool bar was scrolled to
};

}  // namespace rebake
