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
#include "editor/gui/view/viewport.h"
#include "editor/gui/window/commands.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

// Frames that Dear ImGui needs after an event until hovering, popups and focus have settled.
constexpr int frames_after_event = 3;

void set_looks(bool dark) {
  if (dark)
    ImGui::StyleColorsDark();
  else
    ImGui::StyleColorsLight();
  ImGuiStyle& style = ImGui::GetStyle();
  style.WindowRounding = 0;
  style.FrameRounding = 3;
  style.WindowBorderSize = 1;
}

void load_font(double scale) {
  ImGuiIO& io = ImGui::GetIO();
  constexpr const char* font = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
  const auto size = static_cast<float>(14 * scale);
  // The font that comes with Dear ImGui is a picture of 13 pixels.
  // Latin, punctuation and mathematical signs.
  static constexpr ImWchar ranges[] = {0x20, 0xFF, 0x2010, 0x2026, 0x2190, 0x2193, 0x2200, 0x22FF, 0};
  if (!fs::exists(font) || io.Fonts->AddFontFromFileTTF(font, size, nullptr, ranges) == nullptr) {
    io.Fonts->AddFontDefault();
    io.FontGlobalScale = static_cast<float>(scale);
  }
  ImGui::GetStyle().ScaleAllSizes(static_cast<float>(scale));
}

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
    if (!settings_problem_.empty()) desk_.messages.log.push_back({settings_problem_, true});
    desk_.project.recoverable = std::move(lost_);
    if (!paths.empty()) desk_.project.open(paths);
  }

  void run() {
    int frames = frames_after_event;
    while (!dialogs_.may_quit()) {
      const double pause = frames > 0 ? 0 : desk_.jobs.worker.busy() ? 0.1 : viewport().next_frame_in(desk_);
      if (window().wait(pause) || desk_.jobs.worker.busy()) frames = frames_after_event;
      if (desk_.now != desk_.jobs.worker.snapshot()) frames = frames_after_event;
      frames = std::max(0, frames - 1);
      if (window().wants_to_close()) {
        window().stay_open();
        desk_.asking.quitting = true;
        frames = frames_after_event;
      }
      desk_.update();
      const auto begun = std::chrono::steady_clock::now();
      draw();
      viewport().frame_took(
          std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begun).count());
      if (desk_.jobs.restarts_graphics || window().lost()) {
        restart_graphics();
        frames = frames_after_event;
      }
      keep_settings();
    }
    // The work is saved, or not wanted.
    desk_.jobs.worker.cancel();
    desk_.jobs.worker.start("end", [](Session& session) { session.document.discard_journal(); });
    while (desk_.jobs.worker.busy()) window().wait(0.02);
  }

 private:
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
    scale_ = window().scale();
    dark_ = desk_.settings.dark;
    set_looks(dark_);
    load_font(scale_);
    title_.clear();
    // Nothing may be thrown through the window system.
    window().on_key = [this](const KeyPress& press) {
      try {
        key(press);
      } catch (const std::exception& error) {
        desk_.messages.error = error.what();
      }
    };
    window().on_drop = [this](const std::vector<std::string>& dropped) {
      try {
        desk_.project.open(dropped);
      } catch (const std::exception& error) {
        desk_.messages.error = error.what();
      }
    };
  }

  // The document is not touched: it lives in the worker. Nor are the tools.
  void restart_graphics() {
    desk_.jobs.restarts_graphics = false;
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
    desk_.messages.log.push_back({"the graphics were made anew; the work is as it was"});
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
      desk_.messages.log.push_back({error.what(), true});
    }
  }

  void key(const KeyPress& press) {
    const bool plain = !press.control && !press.alt;
    if (press.key == GLFW_KEY_ESCAPE) {
      escape();
      return;
    }
    // Text fields take what is typed; commands with Ctrl other than those of editing text go on working.
    if (ImGui::GetIO().WantTextInput && (plain || (press.key != GLFW_KEY_S && press.key != GLFW_KEY_P))) return;
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
      desk_.messages.log.push_back({std::string(command->title) + ": there is nothing to do it with"});
  }

  void escape() {
    if (dialogs_.escape(desk_)) return;
    if (ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId)) {
      dialogs_.close_popups();  // a menu or a list of choices
      return;
    }
    if (desk_.asking.palette) {
      desk_.asking.palette = false;
    } else if (desk_.jobs.turntable) {
      desk_.messages.log.push_back(
          {fmt::format("turntable stopped: {} of {} pictures are in {}", desk_.jobs.turntable->next,
                       desk_.jobs.turntable->count, desk_.jobs.turntable->folder.string())});
      desk_.jobs.turntable.reset();
    } else if (!desk_.asking.form.empty()) {
      desk_.asking.form.clear();
    } else if (viewport().cancel(desk_)) {
      return;
    } else if (desk_.jobs.worker.busy()) {
      desk_.jobs.worker.cancel();
    } else {
      desk_.tools.kind = ToolKind::pick;
    }
  }

  void draw() {
    set_title();
    if (dark_ != desk_.settings.dark) {
      dark_ = desk_.settings.dark;
      set_looks(dark_);
    }
    window().begin_frame();
    menu();
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    const float top = ImGui::GetFrameHeight(), line = ImGui::GetFrameHeight() + 2 * ImGui::GetStyle().WindowPadding.y;
    const auto s = static_cast<float>(scale_);
    const float height = screen.y - top - line;  // above the status line
    // In a small window the picture comes first.
    const float side = std::min(static_cast<float>(desk_.settings.side_width) * s, 0.4F * screen.x), tools = 66 * s,
                bottom = std::min(static_cast<float>(desk_.settings.bottom_height) * s, 0.3F * height);
    const float options = std::max(line, options_height_);
    panel("tool bar", {0, top}, {tools, height - bottom}, [&] { tool_bar(); });
    panel("options", {tools, top}, {screen.x - tools - side, options}, [&] {
      viewport().tool(desk_).options(desk_);
      options_height_ = ImGui::GetItemRectMax().y - ImGui::GetWindowPos().y + ImGui::GetStyle().WindowPadding.y;
    });
    panel(
        "picture", {tools, top + options}, {screen.x - tools - side, height - bottom - options},
        [&] { viewport().draw(desk_); }, true);
    panel("outline", {screen.x - side, top}, {side, (height - bottom) * 0.55F}, [&] {
      ImGui::TextDisabled("Outline");
      outline_.draw(desk_);
    });
    panel("properties", {screen.x - side, top + (height - bottom) * 0.55F}, {side, (height - bottom) * 0.45F}, [&] {
      ImGui::TextDisabled("Properties");
      properties_.draw(desk_);
    });
    panel("bottom", {0, top + height - bottom}, {screen.x, bottom}, [&] { tabs(); });
    panel("status", {0, screen.y - line}, {screen.x, line}, [&] { status(); });
    splitter("side", {screen.x - side - 3, top}, {6, height - bottom}, ImGuiMouseCursor_ResizeEW,
             [&](const ImVec2& moved) {
               desk_.settings.side_width =
                   std::clamp(desk_.settings.side_width - static_cast<double>(moved.x / s), 200.0, 700.0);
             });
    splitter("height", {0, top + height - bottom - 3}, {screen.x, 6}, ImGuiMouseCursor_ResizeNS,
             [&](const ImVec2& moved) {
               desk_.settings.bottom_height =
                   std::clamp(desk_.settings.bottom_height - static_cast<double>(moved.y / s), 80.0, 500.0);
             });
    palette_.draw(desk_);
    form_.draw(desk_);
    dialogs_.draw(desk_);
    window().end_frame();
  }

  template <class Content>
  void panel(const char* name, const ImVec2& at, const ImVec2& size, Content content, bool bare = false) {
    ImGui::SetNextWindowPos(at);
    ImGui::SetNextWindowSize(size);
    if (bare) ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {0, 0});
    ImGui::Begin(name, nullptr,
                 ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoBringToFrontOnFocus | (bare ? ImGuiWindowFlags_NoScrollbar : 0));
    if (bare) ImGui::PopStyleVar();
    content();
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
    if (!ImGui::BeginMainMenuBar()) return;
    for (const char* name : {"File", "Edit", "Select", "Tool", "View"}) {
      if (!ImGui::BeginMenu(name)) continue;
      for (const Command& command : command_table())
        if (command.menu == std::string_view(name)) {
          const std::string keys = command.keys_of(desk_);
          if (ImGui::MenuItem(command.title, keys.substr(0, keys.find(' ')).c_str(), false, command.enabled(desk_)))
            command.run(desk_);
        }
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
    ImGui::EndMainMenuBar();
  }

  void tool_bar() {
    struct Button {
      ToolKind kind;
      const char* label;
    };
    for (const Button& button :
         {Button{ToolKind::pick, "Pick"}, Button{ToolKind::rectangle, "Rect"}, Button{ToolKind::lasso, "Lasso"},
          Button{ToolKind::polygon, "Poly"}, Button{ToolKind::brush, "Brush"}, Button{ToolKind::flood, "Flood"},
          Button{ToolKind::erase, "Erase"}, Button{ToolKind::move, "Move"}, Button{ToolKind::turn, "Turn"},
          Button{ToolKind::scale, "Scale"}, Button{ToolKind::cage, "Cage"}, Button{ToolKind::bend, "Bend"}}) {
      const bool taken = desk_.tools.kind == button.kind;
      if (taken) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
      if (ImGui::Button(button.label, {-1, 0})) desk_.tools.kind = button.kind;
      if (taken) ImGui::PopStyleColor();
    }
  }

  void tabs() {
    if (!ImGui::BeginTabBar("tabs")) return;
    const auto tab = [](const char* name, const auto& content) {
      if (!ImGui::BeginTabItem(name)) return;
      ImGui::BeginChild(name);
      content();
      ImGui::EndChild();
      ImGui::EndTabItem();
    };
    tab("History", [&] { history_.draw(desk_); });
    tab("Script", [&] { script_.draw(desk_); });
    tab("Cost", [&] { draw_costs(desk_.jobs, desk_.view, *desk_.now, viewport().report(), viewport().each_pass()); });
    tab("Log", [&] { draw_log(desk_.messages); });
    ImGui::EndTabBar();
  }

  void status() {
    if (desk_.jobs.turntable) {
      ImGui::Text("turntable: picture %d of %d (Esc ends it)", desk_.jobs.turntable->next + 1,
                  desk_.jobs.turntable->count);
      return;
    }
    if (desk_.jobs.worker.busy()) {
      const Worker::Status status = desk_.jobs.worker.status();
      if (ImGui::SmallButton("Cancel")) desk_.jobs.worker.cancel();
      ImGui::SameLine();
      ImGui::ProgressBar(static_cast<float>(status.share), {160, 0});
      ImGui::SameLine();
      ImGui::TextUnformatted((status.what.empty() ? status.title : status.title + ": " + status.what).c_str());
      return;
    }
    if (!desk_.messages.log.empty()) {
      const Messages::Line& last = desk_.messages.log.back();
      ImGui::TextUnformatted(last.text.substr(0, 160).c_str());
    } else {
      ImGui::TextDisabled(
          "middle button turns, Shift + middle or right button moves, wheel zooms; Ctrl+P: all commands");
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
  HistoryPanel history_;
  ScriptPanel script_;
  PalettePanel palette_;
  EditForm form_;
  Dialogs dialogs_;
  double scale_ = 1;
  float options_height_ = 0;  ///< that the tool's options took in the last frame
  bool dark_ = true;
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
