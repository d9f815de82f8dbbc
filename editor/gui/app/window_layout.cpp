#include "editor/gui/app/window_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "editor/edits/stored_view.h"
#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/icons.h"
#include "editor/gui/ui/widgets.h"

namespace rebake {

namespace {

template <class Content>
void panel(const char* name, const ImVec2& at, const ImVec2& size, Content content, const ImVec2& padding = {-1, -1},
           ImGuiWindowFlags flags = 0) {
  ImGui::SetNextWindowPos(at);
  ImGui::SetNextWindowSize(size);
  if (padding.x >= 0) ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, padding);
  ImGui::Begin(name, nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoBringToFrontOnFocus | flags);
  if (padding.x >= 0) ImGui::PopStyleVar();
  content();
  // Separator lines instead of a frame around each panel.
  ImGui::GetWindowDrawList()->AddLine({at.x, at.y}, {at.x + size.x, at.y}, color32(theme().border));
  ImGui::GetWindowDrawList()->AddLine({at.x, at.y}, {at.x, at.y + size.y}, color32(theme().border));
  ImGui::End();
}

template <class Moved>
void splitter(const char* name, const ImVec2& at, const ImVec2& size, ImGuiMouseCursor cursor, Moved moved) {
  ImGui::SetNextWindowPos(at);
  ImGui::SetNextWindowSize(size);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {0, 0});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, {1, 1});
  ImGui::Begin(name, nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoBackground |
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoFocusOnAppearing);
  ImGui::InvisibleButton("handle", size);
  if (ImGui::IsItemHovered() || ImGui::IsItemActive()) ImGui::SetMouseCursor(cursor);
  if (ImGui::IsItemActive()) moved(ImGui::GetIO().MouseDelta);
  ImGui::End();
  ImGui::PopStyleVar(2);
}

// Draws a lasso icon over the last item, because the icon font has none: a dashed loop with a loose end.
void draw_lasso(ImU32 color) {
  const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
  const ImVec2 middle{(low.x + high.x) / 2, (low.y + high.y) / 2 - px(2)};
  ImDrawList& list = *ImGui::GetWindowDrawList();
  constexpr int dashes = 9;
  for (int k = 0; k < dashes; ++k) {
    ImVec2 arc[4];
    for (int i = 0; i < 4; ++i) {
      const float angle = 6.2832F * (static_cast<float>(k) + 0.2F * static_cast<float>(i)) / dashes + 0.5F;
      arc[i] = {middle.x + px(8.5F) * std::cos(angle), middle.y + px(6) * std::sin(angle)};
    }
    list.AddPolyline(arc, 4, color, 0, px(1.8F));
  }
  list.AddBezierQuadratic({middle.x - px(5), middle.y + px(5)}, {middle.x - px(7), middle.y + px(9)},
                          {middle.x - px(1), middle.y + px(11)}, color, px(1.8F));
}

}  // namespace

void WindowLayout::draw(Viewport& viewport, const std::vector<std::array<double, 2>>& moves) {
  viewport_ = &viewport;
  moves_ = &moves;
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  if (editor_.view.alone)
    picture({0, 0}, screen);
  else
    lay_out(screen);
  // Thumbnails hold the nodes of their scene, so they are freed when the panel is closed.
  if (!std::exchange(views_shown_, false)) viewport.thumbnails().forget_views();
  palette_.draw(editor_);
  form_.draw(editor_, editor_.dialogs, editor_.view.alone ? screen.x : screen.x - side_width(screen));
  training_.draw(editor_, editor_.view.alone ? screen.x : screen.x - side_width(screen));
  draw_keys_sheet(editor_.dialogs, editor_.settings);
}

// Width of the side panels in pixels, at most 40 % of the window.
float WindowLayout::side_width(const ImVec2& screen) const {
  return std::min(static_cast<float>(editor_.settings.side_width) * px(1), 0.4F * screen.x);
}

void WindowLayout::lay_out(const ImVec2& screen) {
  menu();
  const float top = menu_height_, status_line = ImGui::GetFrameHeight() + px(6);
  const float height = screen.y - top - status_line;
  const auto s = px(1);
  const float side = side_width(screen), tools = px(50);
  const float bottom = !editor_.settings.bottom_open
                           ? 0
                           : std::min(static_cast<float>(editor_.settings.bottom_height) * s, 0.45F * height);
  const float line = ImGui::GetFrameHeight() + px(14), options = std::max(line, options_height_);
  panel(
      "tool bar", {0, top}, {tools, height}, [&] { tool_bar(); }, {px(8), px(8)}, ImGuiWindowFlags_NoScrollbar);
  panel(
      "options", {tools, top}, {screen.x - tools - side, options},
      [&] {
        scope();
        const announce::Part part("options");
        viewport_->tool(editor_).options(editor_);
        options_height_ = ImGui::GetCursorPosY() - ImGui::GetStyle().ItemSpacing.y + px(7);
      },
      {px(10), px(7)}, ImGuiWindowFlags_NoScrollbar);
  picture({tools, top + options}, {screen.x - tools - side, height - bottom - options});
  sides({screen.x - side, top}, {side, height - bottom});
  if (bottom > 0) panel("bottom", {tools, top + height - bottom}, {screen.x - tools, bottom}, [&] { tabs(); });
  panel("status", {0, screen.y - status_line}, {screen.x, status_line}, [&] { status(); }, {px(10), px(3)});
  splitter("side", {screen.x - side - px(3), top}, {px(6), height - bottom}, ImGuiMouseCursor_ResizeEW,
           [&](const ImVec2& moved) {
             editor_.settings.side_width =
                 std::clamp(editor_.settings.side_width - static_cast<double>(moved.x / s), 200.0, 700.0);
           });
  if (bottom > 0)
    splitter("height", {tools, top + height - bottom - px(3)}, {screen.x - tools, px(6)}, ImGuiMouseCursor_ResizeNS,
             [&](const ImVec2& moved) {
               editor_.settings.bottom_height =
                   std::clamp(editor_.settings.bottom_height - static_cast<double>(moved.y / s), 80.0, 800.0);
             });
}

// The viewport and the panels that float over it.
void WindowLayout::picture(const ImVec2& at, const ImVec2& size) {
  panel(
      "picture", at, size, [&] { viewport_->draw(editor_, *moves_); }, {0, 0}, ImGuiWindowFlags_NoScrollbar);
  editor_.view.marked.reset();  // panels set it again in each frame
  draw_start(editor_, viewport_->thumbnails(), {at.x + size.x / 2, at.y + size.y / 2});
  if (!editor_.view.alone) adjust_.draw(editor_, {at.x, at.y + size.y}, size);
  draw_toasts(editor_.messages, {at.x + size.x, at.y + size.y});
  context_menu();
}

void WindowLayout::sides(const ImVec2& at, const ImVec2& size) {
  Settings& settings = editor_.settings;
  const float closed = px(space::heading + 26);
  const bool both = settings.outline_open && settings.properties_open;
  const float upper = !settings.outline_open      ? closed
                      : !settings.properties_open ? size.y - closed
                                                  : size.y * static_cast<float>(settings.outline_share);
  panel("outline", at, {size.x, upper - 1}, [&] {
    if (ui::section("Outline", settings.outline_open)) outline_.draw(editor_, editor_.dialogs);
  });
  panel("properties", {at.x, at.y + upper}, {size.x, size.y - upper}, [&] {
    if (ui::section("Properties", settings.properties_open)) properties_.draw(editor_);
  });
  if (both)
    splitter("sides", {at.x, at.y + upper - px(3)}, {size.x, px(6)}, ImGuiMouseCursor_ResizeNS,
             [&](const ImVec2& moved) {
               settings.outline_share =
                   std::clamp(settings.outline_share + static_cast<double>(moved.y / size.y), 0.15, 0.85);
             });
}

// Shows which nodes the current tool works on.
void WindowLayout::scope() {
  const ToolKind kind = editor_.tools.kind;
  if (kind == ToolKind::pick || editor_.scene().roots.empty()) return;
  ImGui::AlignTextToFramePadding();
  ImGui::PushStyleColor(ImGuiCol_Text, color(theme().accent_text));
  ImGui::TextUnformatted(ui::shortened(editor_.scope_words(), px(160)).c_str());
  ImGui::PopStyleColor();
  ui::tip("Scope: " + editor_.scope_words(), "",
          "Tools work on the picked nodes, or on all visible, unlocked nodes if none are picked.");
  ImGui::SameLine(0, px(space::section));
}

void WindowLayout::context_menu() {
  if (std::exchange(editor_.dialogs.context, false)) ImGui::OpenPopup("context");
  if (!ImGui::BeginPopup("context")) return;
  const announce::Part part("context");
  for (const char* title : {"Frame selection", "", "Duplicate", "Group", "Hide", "Show all", "Separate", "", "Grow",
                            "Shrink", "Connected", "Invert", "", "Delete", "Remove picked nodes"}) {
    if (*title == '\0') {
      ImGui::Separator();
      continue;
    }
    menu_item(command_named(title));
  }
  ImGui::EndPopup();
}

void WindowLayout::menu_item(const Command& command) {
  const bool checked = command.checked != nullptr && command.checked(editor_);
  if (ImGui::MenuItem(command.title, command.key_of(editor_.settings).c_str(), checked, command.enabled(editor_)))
    run_command(editor_, command);
  announce::item(command.title);
  if (*command.help != '\0') ui::tip(command.title, "", command.help);
}

void WindowLayout::menu() {
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, {px(8), px(7)});
  if (!ImGui::BeginMainMenuBar()) {
    ImGui::PopStyleVar();
    return;
  }
  menu_height_ = ImGui::GetWindowHeight();
  const announce::Part part("menu");
  for (const char* name : {"File", "Edit", "Select", "Tool", "View", "Window", "Help"}) {
    // In a small window a menu scrolls below the bar.
    ImGui::SetNextWindowSizeConstraints({0, 0}, {1e5F, ImGui::GetIO().DisplaySize.y - menu_height_ - px(4)});
    const bool open = ImGui::BeginMenu(name);
    announce::item(name);
    if (!open) continue;
    for (const Command& command : command_table())
      if (command.menu == std::string_view(name)) menu_item(command);
    if (name == std::string_view("File") && ImGui::BeginMenu("Recent", !editor_.settings.recent.empty())) {
      const std::vector<std::string> recent = editor_.settings.recent;
      for (const std::string& path : recent)
        if (ImGui::MenuItem(path.c_str())) editor_.project.open({path});
      ImGui::EndMenu();
    }
    if (name == std::string_view("View") && ImGui::BeginMenu("Stored views", !editor_.scene().views.empty())) {
      for (const std::string& view : view_names(editor_.scene()))
        if (ImGui::MenuItem(view.c_str())) editor_.view.camera = editor_.scene().views.at(view);
      ImGui::EndMenu();
    }
    ImGui::EndMenu();
  }
  ImGui::PopStyleVar();
  ImGui::EndMainMenuBar();
}

void WindowLayout::tool_bar() {
  const announce::Part part("tool");
  for (const ToolButton& button : tool_buttons()) {
    if (button.begins_group) {
      ImGui::Dummy({0, px(1)});
      const ImVec2 at = ImGui::GetCursorScreenPos();
      ImGui::GetWindowDrawList()->AddLine({at.x + px(5), at.y}, {at.x + px(29), at.y}, color32(theme().text, 0.15F));
      ImGui::Dummy({0, px(1)});
    }
    const Command& command = command_named(button.command);
    const bool taken = editor_.tools.kind == button.kind;
    if (ui::icon_button(button.icon, command.title, taken)) editor_.tools.kind = button.kind;
    // In a small window the button may be scrolled out of view.
    if (taken && std::exchange(shown_tool_, button.kind) != button.kind) ImGui::SetScrollHereY();
    if (button.kind == ToolKind::lasso) draw_lasso(color32(taken ? theme().on_accent : theme().text));
    ui::tip(command.title, command.key_of(editor_.settings), command.help);
  }
}

void WindowLayout::tabs() {
  const announce::Part part("tabs");
  int tab = static_cast<int>(editor_.settings.bottom_tab);
  if (ui::choice("tabs", tab,
                 {"History##history", "Views##views", "Light##light", "Script##script", "Performance##cost",
                  "Message log##messages"}))
    editor_.settings.bottom_tab = static_cast<BottomTab>(tab);
  ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - px(24));
  if (ui::quiet_icon(icons::close, "Close")) editor_.settings.bottom_open = false;
  ImGui::BeginChild("content");
  switch (editor_.settings.bottom_tab) {
    case BottomTab::history:
      history_.draw(editor_);
      break;
    case BottomTab::views:
      views_.draw(editor_, Viewport::drawn(editor_), viewport_->thumbnails());
      views_shown_ = true;
      break;
    case BottomTab::light:
      light_.draw(editor_);
      break;
    case BottomTab::script:
      script_.draw(editor_, editor_.dialogs);
      break;
    case BottomTab::cost:
      draw_costs(editor_.jobs, editor_.view, *editor_.now, viewport_->report(), viewport_->each_pass());
      break;
    default:
      draw_log(editor_.messages);
  }
  ImGui::EndChild();
}

void WindowLayout::status() {
  const announce::Part part("status");
  ImGui::AlignTextToFramePadding();
  if (editor_.jobs.film) {
    ImGui::Text("%s (Esc cancels)", editor_.jobs.film->doing().c_str());
  } else if (editor_.jobs.worker.busy()) {
    const Worker::Status now = editor_.jobs.worker.status();
    if (ui::quiet_icon(icons::close, "Cancel")) editor_.jobs.worker.cancel();
    ui::tip("Cancel", "Esc");
    ImGui::SameLine();
    ImGui::ProgressBar(static_cast<float>(now.share), {px(160), px(6)}, "");
    ImGui::SameLine();
    std::string what = now.what.empty() ? now.title : now.title + ": " + now.what;
    std::replace(what.begin(), what.end(), '_', ' ');
    ImGui::TextUnformatted(what.c_str());
  } else if (editor_.training.state() != TrainingJob::State::none) {
    const Worker::Status now = editor_.training.status();
    if (ui::quiet_icon(icons::image_multiple, "Training")) editor_.dialogs.training = true;
    ui::tip("Train from photographs");
    ImGui::SameLine();
    ImGui::ProgressBar(static_cast<float>(now.share), {px(160), px(6)}, "");
    ImGui::SameLine();
    ImGui::TextUnformatted(editor_.training.state() == TrainingJob::State::paused ? "training paused"
                                                                                  : now.what.c_str());
  } else if (viewport_->arrived() < 1) {
    ImGui::ProgressBar(static_cast<float>(viewport_->arrived()), {px(160), px(6)}, "");
    ImGui::SameLine();
    ImGui::TextUnformatted("uploading to the graphics card");
  } else if (!editor_.status.empty()) {
    ImGui::TextUnformatted(ui::shortened(editor_.status, 0.5F * ImGui::GetWindowWidth()).c_str());
  } else {
    ImGui::TextDisabled("Middle button orbits, wheel zooms. F1 shows all keys, Ctrl+P finds any command.");
  }
  // On the right: the size of the selection, and buttons for the tabs of the bottom panel.
  std::string selected = editor_.selected_words();
  if (!selected.empty() && editor_.visible_selection_count() > 0) selected += ", visible sides only";
  const float buttons = px(6 * 30);
  ImGui::SameLine(ImGui::GetWindowWidth() - buttons - px(20) - ImGui::CalcTextSize(selected.c_str()).x);
  ImGui::TextDisabled("%s", selected.c_str());
  ImGui::SameLine(ImGui::GetWindowWidth() - buttons);
  struct Tab {
    BottomTab tab;
    const char* icon;
    const char* command;
  };
  for (const Tab& one :
       {Tab{BottomTab::history, icons::history, "History"}, Tab{BottomTab::views, icons::image_multiple, "Views"},
        Tab{BottomTab::light, icons::weather_sunny, "Light"}, Tab{BottomTab::script, icons::script, "Script"},
        Tab{BottomTab::cost, icons::chart_line, "Performance"},
        Tab{BottomTab::log, icons::message_text, "Message log"}}) {
    const Command& command = command_named(one.command);
    const bool open = editor_.settings.bottom_open && editor_.settings.bottom_tab == one.tab;
    if (ui::quiet_icon(one.icon, one.command, open)) command.run(editor_);
    ui::tip(command.title, command.key_of(editor_.settings), command.help);
    ImGui::SameLine(0, px(6));
  }
}

}  // namespace rebake
