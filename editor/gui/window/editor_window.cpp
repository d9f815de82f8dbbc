#include "editor/gui/window/editor_window.h"

#include <GLFW/glfw3.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>

#include "editor/document/journal.h"
#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/fonts.h"
#include "editor/gui/ui/icons.h"
#include "editor/gui/ui/number_field.h"
#include "editor/gui/ui/widgets.h"
#include "editor/gui/view/viewport.h"
#include "editor/gui/window/commands.h"
#include "editor/gui/window/desktop.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

// Frames that Dear ImGui needs after an event until hovering, popups and focus have settled.
constexpr int frames_after_event = 4;

/// Everything in the window, laid out.
class EditorWindow {
 public:
  explicit EditorWindow(const std::vector<std::string>& paths)
      : settings_file_(config_folder() / "settings.json"),
        kept_settings_(read_settings(settings_file_, settings_problem_)),
        tools_(make_tools()),
        graphics_(std::make_unique<Graphics>(system_, kept_settings_, tools_)),
        lost_(lost_work()),
        desk_(kept_settings_, WindowSystem::wake) {
    begin_graphics();
    if (!settings_problem_.empty()) desk_.messages.fail(settings_problem_);
    desk_.project.recoverable = std::move(lost_);
    if (!paths.empty()) desk_.project.open(paths);
  }

  void run() {
    frames_ = frames_after_event;
    while (!dialogs_.may_quit()) {
      const double pause = frames_ > 0 ? 0 : desk_.jobs.worker.busy() ? 0.1 : next_frame_in();
      const auto waits = std::chrono::steady_clock::now();
      if (window().wait(pause) || desk_.jobs.worker.busy()) frames_ = frames_after_event;
      if (pause == 0) paused(waits);
      if (desk_.now != desk_.jobs.worker.snapshot()) frames_ = frames_after_event;
      frames_ = std::max(0, frames_ - 1);
      if (window().wants_to_close()) {
        window().stay_open();
        desk_.asking.quitting = true;
        frames_ = frames_after_event;
      }
      const auto begun = std::chrono::steady_clock::now();
      desk_.update();
      draw();
      viewport().frame_took(
          std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begun).count());
      paused(begun);
      if (desk_.jobs.restarts_graphics || window().lost()) {
        restart_graphics();
        frames_ = frames_after_event;
      }
      keep_settings();
    }
    // The work is saved, or not wanted.
    desk_.jobs.worker.cancel();
    desk_.jobs.worker.start("end", [](Session& session) { session.document.discard_journal(); });
    while (desk_.jobs.worker.busy()) window().wait(0.02);
    desk_.jobs.worker.set_prepare(nullptr);
    desk_.previews.set_prepare(nullptr);
  }

 private:
  double next_frame_in() {
    const double view = viewport().next_frame_in(desk_), messages = desk_.messages.changes_in();
    return view < 0 ? messages : messages < 0 ? view : std::min(view, messages);
  }
  void paused(std::chrono::steady_clock::time_point since) {
    longest_pause_ms_ = std::max(
        longest_pause_ms_, std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - since).count());
  }

  /// What lives on the GPU, and ends with its context.
  struct Graphics {
    Window window;
    Renderer renderer;
    Viewport viewport;
    Graphics(const WindowSystem& system, const Settings& settings, Tools& tools)
        : window(system, "Rebake", settings.window_width, settings.window_height),
          renderer(window.context()),
          viewport(renderer, tools, [this] { return window.context(); }) {}
  };
  Window& window() { return graphics_->window; }
  Viewport& viewport() { return graphics_->viewport; }

  void begin_graphics() {
    looks_of_.reset();
    set_looks();
    title_.clear();
    const auto prepare = [&renderer = graphics_->renderer](const Scene& scene) { renderer.prepare(scene); };
    desk_.jobs.worker.set_prepare(prepare);
    desk_.previews.set_prepare(prepare);
    // Nothing may be thrown through the window system.
    window().on_key = [this](const KeyPress& press) {
      try {
        key(press);
      } catch (const std::exception& error) {
        desk_.messages.fail(error.what());
      }
    };
    window().on_drop = [this](const std::vector<std::string>& dropped) {
      try {
        desk_.project.open(dropped);
      } catch (const std::exception& error) {
        desk_.messages.fail(error.what());
      }
    };
  }

  // The document is not touched: it lives in the worker. Nor are the tools.
  void restart_graphics() {
    desk_.jobs.restarts_graphics = false;
    desk_.jobs.worker.set_prepare(nullptr);
    desk_.previews.set_prepare(nullptr);
    graphics_.reset();
    // A driver that was reset may need a while.
    constexpr int tries = 20;
    for (int k = 1; !graphics_; ++k) {
      try {
        graphics_ = std::make_unique<Graphics>(system_, desk_.settings, tools_);
      } catch (const DeviceError& error) {
        if (k == tries)
          throw DeviceError(
              fmt::format("{}; the work is in the journal: start \"rebake edit\" again to get it back", error.what()));
        std::this_thread::sleep_for(std::chrono::milliseconds(500));
      }
    }
    begin_graphics();
    desk_.jobs.worker.drop_renderer();
    desk_.messages.say("The graphics were made anew; the work is as it was.");
  }

  // What other editors left behind when they ended without saving, the latest first.
  static std::vector<Project::LostWork> lost_work() {
    std::vector<Project::LostWork> found;
    std::error_code error;
    for (fs::directory_iterator at(journal_folder(), error), end; !error && at != end; at.increment(error)) {
      const fs::path& path = at->path();
      if (path.extension() != ".journal" || Journal::in_use(path)) continue;
      try {
        const Journal::Contents contents = Journal::read(path);
        std::string first;
        for (const std::string& text : contents.entries) {
          const nlohmann::json entry = nlohmann::json::parse(text);
          if (first.empty() && entry.contains("edit") && entry.at("edit").contains("path"))
            first = entry.at("edit").at("path").get<std::string>();
        }
        if (!contents.entries.empty()) {
          found.push_back({path, fmt::format("{} edits, {}", contents.entries.size(), first)});
          continue;
        }
        // Nothing was done there; a fresh one may be another editor's that is just starting.
        std::error_code unknown;
        const auto age = fs::file_time_type::clock::now() - fs::last_write_time(path, unknown);
        if (!unknown && age > std::chrono::minutes(1)) fs::remove(path, unknown);
      } catch (const std::exception& problem) {
        found.push_back({path, problem.what()});
      }
    }
    std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.journal > b.journal; });
    return found;
  }

  // On the disk once nothing is held any more, so that they are there however the editor ends.
  void keep_settings() {
    desk_.settings.window_width = static_cast<int>(window().width() / scale_);
    desk_.settings.window_height = static_cast<int>(window().height() / scale_);
    if (desk_.settings == kept_settings_ || ImGui::IsAnyMouseDown()) return;
    kept_settings_ = desk_.settings;
    try {
      write_settings(kept_settings_, settings_file_);
    } catch (const Error& error) {
      desk_.messages.fail(error.what());
    }
  }

  void key(const KeyPress& press) {
    longest_pause_ms_ = 0;
    const bool plain = !press.control && !press.alt;
    if (press.key == GLFW_KEY_ESCAPE) {
      const bool in_panel = !desk_.asking.palette && !desk_.asking.keys && desk_.asking.form.empty() && !asks();
      // A field takes its own.
      if (in_panel && (ui::cancel_drag() || ui::takes_text())) return;
      escape();
      return;
    }
    // The sheet of keys lies over all: what is not seen is not done.
    if (desk_.asking.keys && press.key != GLFW_KEY_F1) return;
    // Text fields take what is typed; commands with Ctrl other than those of editing text go on working.
    if ((ui::takes_text() || desk_.asking.palette) && (plain || (press.key != GLFW_KEY_S && press.key != GLFW_KEY_P)))
      return;
    if (ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId)) return;
    if (viewport().key(desk_, press)) return;
    if (viewport().tool(desk_).busy()) return;  // nothing else happens during a drag
    const bool letter = press.key >= 'A' && press.key <= 'Z';
    if (desk_.view.flying && plain && letter &&
        std::string_view("WASDQE").find(static_cast<char>(press.key)) != std::string_view::npos)
      return;
    const Command* command = command_for(press, desk_);
    if (command == nullptr || (press.repeated && !command->repeats)) return;
    if (command->enabled(desk_))
      command->run(desk_);
    else
      desk_.messages.say(std::string(command->title) + ": there is nothing to do it with.");
  }

  // Whether a dialog waits for an answer.
  bool asks() const {
    return desk_.asking.path != PathQuestion::none || desk_.asking.quitting || !desk_.project.recoverable.empty() ||
           desk_.project.relinking.has_value() || !desk_.project.to_open.empty();
  }

  void escape() {
    if (dialogs_.escape(desk_)) return;
    if (ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId)) {
      dialogs_.close_popups();  // a menu or a list of choices
      return;
    }
    if (desk_.asking.palette || desk_.asking.keys) {
      desk_.asking.palette = desk_.asking.keys = false;
    } else if (desk_.jobs.turntable) {
      desk_.messages.say(fmt::format("Stopped: {} of {} pictures are in {}", desk_.jobs.turntable->next,
                                     desk_.jobs.turntable->count, desk_.jobs.turntable->folder.string()));
      desk_.jobs.turntable.reset();
    } else if (!desk_.asking.form.empty()) {
      desk_.asking.form.clear();
    } else if (viewport().cancel(desk_) || desk_.messages.close_failures()) {
      return;
    } else if (desk_.jobs.worker.busy()) {
      desk_.jobs.worker.cancel();
    } else if (desk_.tools.kind != ToolKind::pick) {
      desk_.tools.kind = ToolKind::pick;
    } else {
      desk_.active.clear();
    }
  }

  // Colours, distances and fonts of the window, where they are not as they are wanted.
  void set_looks() {
    const Settings& settings = desk_.settings;
    const bool dark = settings.looks == Looks::dark || (settings.looks == Looks::system && system_dark_);
    const WantedLooks wanted{dark, window().scale() * settings.text_scale};
    if (looks_of_ == wanted) return;
    if (!looks_of_ || looks_of_->scale != wanted.scale) {
      load_fonts(static_cast<float>(wanted.scale));
      window().renew_fonts();
    }
    looks_of_ = wanted;
    scale_ = wanted.scale;
    set_style(dark ? dark_theme() : light_theme(), static_cast<float>(scale_));
  }

  void draw() {
    set_title();
    set_looks();
    window().begin_frame();
    ImGui::PushFont(fonts().text);
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    if (desk_.view.alone) {
      picture({0, 0}, screen);
    } else {
      lay_out(screen);
    }
    palette_.draw(desk_);
    form_.draw(desk_);
    draw_keys_sheet(desk_);
    dialogs_.draw(desk_);
    ImGui::PopFont();
    window().end_frame();
    tell();
  }

  void lay_out(const ImVec2& screen) {
    menu();
    const float top = menu_height_, status_line = ImGui::GetFrameHeight() + px(6);
    const float height = screen.y - top - status_line;
    // In a small window the picture comes first.
    const auto s = static_cast<float>(scale_);
    const float side = std::min(static_cast<float>(desk_.settings.side_width) * s, 0.4F * screen.x), tools = px(50);
    const float bottom = !desk_.settings.bottom_open
                             ? 0
                             : std::min(static_cast<float>(desk_.settings.bottom_height) * s, 0.45F * height);
    const float line = ImGui::GetFrameHeight() + px(14), options = std::max(line, options_height_);
    panel(
        "tool bar", {0, top}, {tools, height}, [&] { tool_bar(); }, {px(8), px(8)}, ImGuiWindowFlags_NoScrollbar);
    panel(
        "options", {tools, top}, {screen.x - tools - side, options},
        [&] {
          scope();
          const announce::Part part("options");
          viewport().tool(desk_).options(desk_);
          options_height_ = ImGui::GetCursorPosY() - ImGui::GetStyle().ItemSpacing.y + px(7);
        },
        {px(10), px(7)}, ImGuiWindowFlags_NoScrollbar);
    picture({tools, top + options}, {screen.x - tools - side, height - bottom - options});
    sides({screen.x - side, top}, {side, height - bottom});
    if (bottom > 0) panel("bottom", {tools, top + height - bottom}, {screen.x - tools, bottom}, [&] { tabs(); });
    panel("status", {0, screen.y - status_line}, {screen.x, status_line}, [&] { status(); }, {px(10), px(3)});
    splitter("side", {screen.x - side - px(3), top}, {px(6), height - bottom}, ImGuiMouseCursor_ResizeEW,
             [&](const ImVec2& moved) {
               desk_.settings.side_width =
                   std::clamp(desk_.settings.side_width - static_cast<double>(moved.x / s), 200.0, 700.0);
             });
    if (bottom > 0)
      splitter("height", {tools, top + height - bottom - px(3)}, {screen.x - tools, px(6)}, ImGuiMouseCursor_ResizeNS,
               [&](const ImVec2& moved) {
                 desk_.settings.bottom_height =
                     std::clamp(desk_.settings.bottom_height - static_cast<double>(moved.y / s), 80.0, 800.0);
               });
  }

  // The picture and what floats over it.
  void picture(const ImVec2& at, const ImVec2& size) {
    panel(
        "picture", at, size, [&] { viewport().draw(desk_, window().moves()); }, {0, 0}, ImGuiWindowFlags_NoScrollbar);
    draw_start(desk_, {at.x + size.x / 2, at.y + size.y / 2});
    if (!desk_.view.alone) adjust_.draw(desk_, {at.x, at.y + size.y}, size);
    draw_toasts(desk_.messages, {at.x + size.x, at.y + size.y});
    context_menu();
  }

  void sides(const ImVec2& at, const ImVec2& size) {
    Settings& settings = desk_.settings;
    const float closed = px(space::heading + 26);
    const bool both = settings.outline_open && settings.properties_open;
    const float upper = !settings.outline_open      ? closed
                        : !settings.properties_open ? size.y - closed
                                                    : size.y * static_cast<float>(settings.outline_share);
    panel("outline", at, {size.x, upper - 1}, [&] {
      if (ui::section("Outline", settings.outline_open)) outline_.draw(desk_);
    });
    panel("properties", {at.x, at.y + upper}, {size.x, size.y - upper}, [&] {
      if (ui::section("Properties", settings.properties_open)) properties_.draw(desk_);
    });
    if (both)
      splitter("sides", {at.x, at.y + upper - px(3)}, {size.x, px(6)}, ImGuiMouseCursor_ResizeNS,
               [&](const ImVec2& moved) {
                 settings.outline_share =
                     std::clamp(settings.outline_share + static_cast<double>(moved.y / size.y), 0.15, 0.85);
               });
  }

  // What the tool in hand works on.
  void scope() {
    const ToolKind kind = desk_.tools.kind;
    if (kind == ToolKind::pick || desk_.scene().roots.empty()) return;
    ImGui::AlignTextToFramePadding();
    ImGui::PushStyleColor(ImGuiCol_Text, color(theme().accent_text));
    ImGui::TextUnformatted(ui::shortened(desk_.scope_words(), px(160)).c_str());
    ImGui::PopStyleColor();
    ui::tip("Works " + desk_.scope_words(), "",
            "Tools work on the picked nodes; with none picked, on all that is visible and not locked.");
    ImGui::SameLine(0, px(space::section));
  }

  void context_menu() {
    if (std::exchange(desk_.asking.context, false)) ImGui::OpenPopup("context");
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

  void menu_item(const Command& command) {
    const bool checked = command.checked != nullptr && command.checked(desk_);
    if (ImGui::MenuItem(command.title, command.key_of(desk_).c_str(), checked, command.enabled(desk_)))
      command.run(desk_);
    announce::item(command.title);
    if (*command.help != '\0') ui::tip(command.title, "", command.help);
  }

  // For other programs: what is true of the frame that was just drawn.
  void tell() {
    if (!announce::on()) return;
    nlohmann::json state;
    const bool working = !desk_.at_rest() || desk_.jobs.worker.busy() || desk_.previews.busy();
    state["settled"] = !working && !window().input_waits() && viewport().next_frame_in(desk_) < 0 && frames_ == 0;
    state["input"] = {{"keys", window().seen().keys},
                      {"buttons", window().seen().buttons},
                      {"text", window().seen().text},
                      {"wheel", window().seen().wheel},
                      {"pointer", {window().seen().x, window().seen().y}}};
    state["tool"] = command_of_tool(desk_.tools.kind);
    state["selected"] = desk_.selected_triangles();
    state["steps"] = desk_.now->steps_done;
    state["status"] = desk_.status;
    state["preview"] = desk_.preview.has_value();
    state["scope"] = desk_.scope_words();
    state["picked"] = nlohmann::json::array();
    for (const NodeId id : desk_.active)
      if (const NodePtr node = find(desk_.scene(), id)) state["picked"].push_back(node->name);
    state["messages"] = nlohmann::json::array();
    for (const std::size_t k : desk_.messages.shown()) state["messages"].push_back(desk_.messages.log()[k].text);
    state["asks"] = asks();
    state["scale"] = scale_;
    state["window"] = {window().width(), window().height()};
    state["longest_pause_ms"] = std::lround(longest_pause_ms_);
    announce::frame(state);
  }

  static std::string command_of_tool(ToolKind kind) {
    for (const ToolButton& button : tool_buttons())
      if (button.kind == kind) return button.command;
    return "";
  }

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
    // Panels are told apart by a line, not by a frame around each.
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

  void menu() {
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, {px(8), px(7)});
    if (!ImGui::BeginMainMenuBar()) {
      ImGui::PopStyleVar();
      return;
    }
    menu_height_ = ImGui::GetWindowHeight();
    const announce::Part part("menu");
    for (const char* name : {"File", "Edit", "Select", "Tool", "View", "Window", "Help"}) {
      // Below the bar, however small the window: it scrolls.
      ImGui::SetNextWindowSizeConstraints({0, 0}, {1e5F, ImGui::GetIO().DisplaySize.y - menu_height_ - px(4)});
      const bool open = ImGui::BeginMenu(name);
      announce::item(name);
      if (!open) continue;
      for (const Command& command : command_table())
        if (command.menu == std::string_view(name)) menu_item(command);
      if (name == std::string_view("File") && ImGui::BeginMenu("Recent", !desk_.settings.recent.empty())) {
        const std::vector<std::string> recent = desk_.settings.recent;
        for (const std::string& path : recent)
          if (ImGui::MenuItem(path.c_str())) desk_.project.open({path});
        ImGui::EndMenu();
      }
      if (name == std::string_view("View") && ImGui::BeginMenu("Stored views", !desk_.scene().views.empty())) {
        for (const auto& [view, camera] : desk_.scene().views)
          if (ImGui::MenuItem(view.c_str())) desk_.view.camera = camera;
        ImGui::EndMenu();
      }
      ImGui::EndMenu();
    }
    ImGui::PopStyleVar();
    ImGui::EndMainMenuBar();
  }

  void tool_bar() {
    const announce::Part part("tool");
    for (const ToolButton& button : tool_buttons()) {
      if (button.begins_group) {
        ImGui::Dummy({0, px(1)});
        const ImVec2 at = ImGui::GetCursorScreenPos();
        ImGui::GetWindowDrawList()->AddLine({at.x + px(5), at.y}, {at.x + px(29), at.y}, color32(theme().text, 0.15F));
        ImGui::Dummy({0, px(1)});
      }
      const Command& command = command_named(button.command);
      const bool taken = desk_.tools.kind == button.kind;
      if (ui::icon_button(button.icon, command.title, taken)) desk_.tools.kind = button.kind;
      if (button.kind == ToolKind::lasso) draw_lasso(color32(taken ? theme().on_accent : theme().text));
      ui::tip(command.title, command.key_of(desk_), command.help);
    }
  }

  // No font here has a lasso: a loop of dashes with an end that hangs.
  static void draw_lasso(ImU32 color) {
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

  void tabs() {
    const announce::Part part("tabs");
    int tab = static_cast<int>(desk_.settings.bottom_tab);
    if (ui::choice("tabs", tab, {"History", "Script", "Cost", "Messages"}))
      desk_.settings.bottom_tab = static_cast<BottomTab>(tab);
    ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - px(24));
    if (ui::quiet_icon(icons::close, "Close")) desk_.settings.bottom_open = false;
    ImGui::BeginChild("content");
    switch (desk_.settings.bottom_tab) {
      case BottomTab::history:
        history_.draw(desk_);
        break;
      case BottomTab::script:
        script_.draw(desk_);
        break;
      case BottomTab::cost:
        draw_costs(desk_.jobs, desk_.view, *desk_.now, viewport().report(), viewport().each_pass());
        break;
      default:
        draw_log(desk_.messages);
    }
    ImGui::EndChild();
  }

  void status() {
    const announce::Part part("status");
    ImGui::AlignTextToFramePadding();
    if (desk_.jobs.turntable) {
      ImGui::Text("Turntable: picture %d of %d (Esc ends it)", desk_.jobs.turntable->next + 1,
                  desk_.jobs.turntable->count);
    } else if (desk_.jobs.worker.busy()) {
      const Worker::Status now = desk_.jobs.worker.status();
      if (ui::quiet_icon(icons::close, "Stop")) desk_.jobs.worker.cancel();
      ui::tip("Stop", "Esc");
      ImGui::SameLine();
      ImGui::ProgressBar(static_cast<float>(now.share), {px(160), px(6)}, "");
      ImGui::SameLine();
      std::string what = now.what.empty() ? now.title : now.title + ": " + now.what;
      std::replace(what.begin(), what.end(), '_', ' ');
      ImGui::TextUnformatted(what.c_str());
    } else if (!desk_.status.empty()) {
      ImGui::TextUnformatted(ui::shortened(desk_.status, 0.5F * ImGui::GetWindowWidth()).c_str());
    } else {
      ImGui::TextDisabled("Middle button turns, wheel zooms. F1 shows all keys, Ctrl+P finds any command.");
    }
    // What is selected, and how; and what can be opened below.
    std::string selected;
    if (desk_.selected_triangles() > 0)
      selected = fmt::format("{} selected{}", desk_.selected_triangles(),
                             desk_.seen_last() != nullptr ? ", back sides not" : "");
    const float buttons = px(4 * 30);
    ImGui::SameLine(ImGui::GetWindowWidth() - buttons - px(20) - ImGui::CalcTextSize(selected.c_str()).x);
    ImGui::TextDisabled("%s", selected.c_str());
    ImGui::SameLine(ImGui::GetWindowWidth() - buttons);
    struct Tab {
      BottomTab tab;
      const char* icon;
      const char* command;
    };
    for (const Tab& one :
         {Tab{BottomTab::history, icons::history, "History"}, Tab{BottomTab::script, icons::script, "Script"},
          Tab{BottomTab::cost, icons::chart_line, "Cost"}, Tab{BottomTab::log, icons::message_text, "Messages"}}) {
      const Command& command = command_named(one.command);
      const bool open = desk_.settings.bottom_open && desk_.settings.bottom_tab == one.tab;
      if (ui::quiet_icon(one.icon, one.command, open)) command.run(desk_);
      ui::tip(command.title, command.key_of(desk_), command.help);
      ImGui::SameLine(0, px(6));
    }
  }

  void set_title() {
    std::string title = "Rebake";
    if (!desk_.project.path.empty()) title = desk_.project.path.filename().string() + " - " + title;
    if (desk_.project.unsaved()) title = "* " + title;
    if (title != title_) window().set_title(title_ = title);
  }

  fs::path settings_file_;
  std::string settings_problem_;
  Settings kept_settings_;  ///< as they are on the disk
  WindowSystem system_;
  Tools tools_;
  std::unique_ptr<Graphics> graphics_;
  std::vector<Project::LostWork> lost_;  ///< looked for before this editor's own journal is begun
  Desk desk_;
  OutlinePanel outline_;
  PropertiesPanel properties_;
  AdjustPanel adjust_;
  HistoryPanel history_;
  ScriptPanel script_;
  PalettePanel palette_;
  EditForm form_;
  Dialogs dialogs_;
  double scale_ = 1;          ///< pixels of the screen a pixel of a plain one
  float options_height_ = 0;  ///< that the tool's options took in the last frame
  float menu_height_ = 0;
  struct WantedLooks {
    bool dark;
    double scale;
    bool operator==(const WantedLooks&) const = default;
  };
  std::optional<WantedLooks> looks_of_;   ///< what is set
  bool system_dark_ = desktop_is_dark();  ///< as the desktop was when the editor began
  int frames_ = 0;                        ///< still to be drawn after the last event
  double longest_pause_ms_ = 0;           ///< between two frames while there was something to draw, since the last key
  std::string title_;
};

}  // namespace

void run_editor(const std::vector<std::string>& paths) {
  // An editor that is told to end does so at once: its journal keeps the work.
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
  EditorWindow(paths).run();
}

}  // namespace rebake
