#include "editor/gui/app/editor_window.h"

#include <GLFW/glfw3.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>

#include "editor/gui/app/viewport.h"
#include "editor/gui/app/window_layout.h"
#include "editor/gui/panels/dialogs.h"
#include "editor/gui/platform/desktop.h"
#include "editor/gui/state/commands.h"
#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/fonts.h"
#include "editor/gui/ui/number_field.h"
#include "editor/gui/ui/widgets.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

// Number of frames after an event until hovering, popups and focus of Dear ImGui have settled.
constexpr int frames_after_event = 4;
// Seconds without an event before a shader program for another view is compiled.
constexpr double before_making_ahead = 0.3;

/// Event loop of the editor. Handles keys, draws frames, and owns all GPU objects.
class EditorWindow {
 public:
  explicit EditorWindow(const std::vector<std::string>& paths)
      : settings_file_(config_folder() / "settings.json"),
        saved_settings_(read_settings(settings_file_, settings_problem_)),
        tools_(make_tools()),
        graphics_(std::make_unique<Graphics>(system_, saved_settings_, tools_)),
        lost_(lost_work()),
        editor_(saved_settings_, WindowSystem::wake) {
    begin_graphics();
    if (!settings_problem_.empty()) editor_.messages.fail(settings_problem_);
    editor_.project.recoverable = std::move(lost_);
    if (!paths.empty()) editor_.project.open(paths);
  }

  void run() {
    frames_ = frames_after_event;
    while (!dialogs_.may_quit()) {
      const bool works = editor_.jobs.worker.busy() || dialogs_.waits();
      const bool rests = frames_ == 0 && !works && next_frame_in() < 0 && viewport().may_compile_ahead();
      const double pause = frames_ > 0 || viewport().arrived() < 1 ? 0
                           : works                                 ? 0.1
                           : rests                                 ? before_making_ahead
                                                                   : next_frame_in();
      const auto waits = std::chrono::steady_clock::now();
      if (window().wait(pause))
        frames_ = frames_after_event;
      else if (rests)
        viewport().compile_next_program(editor_);
      else if (editor_.jobs.worker.busy() || dialogs_.waits())
        frames_ = std::max(frames_, 1);  // one frame to update the progress bar
      if (pause == 0) paused(waits);
      if (editor_.now != editor_.jobs.worker.snapshot()) frames_ = frames_after_event;
      frames_ = std::max(0, frames_ - 1);
      if (window().wants_to_close()) {
        window().stay_open();
        editor_.dialogs.quitting = true;
        frames_ = frames_after_event;
      }
      const auto begun = std::chrono::steady_clock::now();
      editor_.update();
      // The form of the training changes its size, which takes Dear ImGui two frames.
      if (std::exchange(training_, editor_.training.state()) != editor_.training.state()) frames_ = frames_after_event;
      draw();
      viewport().frame_took(
          std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begun).count());
      paused(begun);
      if (editor_.jobs.restarts_graphics || window().lost()) {
        restart_graphics();
        frames_ = frames_after_event;
      }
      save_changed_settings();
    }
    // The work is saved or discarded, so the journal is no longer needed.
    editor_.jobs.worker.cancel();
    editor_.jobs.worker.start(
        "end", [](Session& session) { session.document.discard_journal(); }, {}, {}, Worker::On::any_document);
    while (editor_.jobs.worker.busy()) window().wait(0.02);
    editor_.jobs.worker.set_prepare(nullptr);
    editor_.previews.set_prepare(nullptr);
  }

 private:
  double next_frame_in() {
    const double view = viewport().next_frame_in(editor_), messages = editor_.messages.changes_in();
    return view < 0 ? messages : messages < 0 ? view : std::min(view, messages);
  }
  void paused(std::chrono::steady_clock::time_point since) {
    longest_pause_ms_ = std::max(
        longest_pause_ms_, std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - since).count());
  }

  /// All GPU objects. They are destroyed together with their context.
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
    applied_style_.reset();
    apply_style();
    title_.clear();
    const auto prepare = [&renderer = graphics_->renderer](const Scene& scene) { renderer.prepare(scene); };
    editor_.jobs.worker.set_prepare(prepare);
    editor_.previews.set_prepare(prepare);
    // Exceptions must not pass through GLFW's C code.
    window().on_key = [this](const KeyPress& press) {
      try {
        key(press);
      } catch (const std::exception& error) {
        editor_.messages.fail(error.what());
      }
    };
    window().on_drop = [this](const std::vector<std::string>& dropped) {
      try {
        editor_.project.open(dropped);
      } catch (const std::exception& error) {
        editor_.messages.fail(error.what());
      }
    };
  }

  // Recreates window and GPU objects. Document (owned by the worker) and tools are not affected.
  void restart_graphics() {
    editor_.jobs.restarts_graphics = false;
    editor_.jobs.worker.set_prepare(nullptr);
    editor_.previews.set_prepare(nullptr);
    graphics_.reset();
    // A driver may need some time after a reset: retries for 10 s.
    constexpr int tries = 20;
    for (int k = 1; !graphics_; ++k) {
      try {
        graphics_ = std::make_unique<Graphics>(system_, editor_.settings, tools_);
      } catch (const DeviceError& error) {
        if (k == tries)
          throw DeviceError(fmt::format(
              "{}; the work is safe in the journal: start \"rebake edit\" again to recover it", error.what()));
        std::this_thread::sleep_for(std::chrono::milliseconds(500));
      }
    }
    begin_graphics();
    editor_.jobs.worker.drop_renderer();
    editor_.messages.say("The graphics were restarted. No work was lost.");
  }

  // Writes changed settings when no button is held, so that they survive a crash.
  void save_changed_settings() {
    editor_.settings.window_width = static_cast<int>(std::lround(window().width() / window().scale()));
    editor_.settings.window_height = static_cast<int>(std::lround(window().height() / window().scale()));
    if (editor_.settings == tried_settings_ || ImGui::IsAnyMouseDown()) return;
    tried_settings_ = editor_.settings;
    try {
      write_settings(tried_settings_, saved_settings_, settings_file_);
      saved_settings_ = tried_settings_;
    } catch (const Error& error) {
      editor_.messages.fail(error.what());
    }
  }

  void key(const KeyPress& press) {
    longest_pause_ms_ = 0;
    const bool plain = !press.control && !press.alt;
    if (press.key == GLFW_KEY_ESCAPE) {
      const bool in_panel = !editor_.dialogs.palette && !editor_.dialogs.keys && !asks();
      // A number field or text box handles Escape itself; a text box of a form closes with it.
      if (in_panel && (ui::cancel_drag() || (editor_.dialogs.form.empty() && ui::takes_text()))) return;
      escape();
      return;
    }
    // The sheet of keys covers the window: commands would run unseen.
    if (editor_.dialogs.keys && press.key != GLFW_KEY_F1) return;
    // Text boxes get all keys except Ctrl+S and Ctrl+P (or with Alt).
    if ((ui::takes_text() || editor_.dialogs.palette) &&
        (plain || (press.key != GLFW_KEY_S && press.key != GLFW_KEY_P)))
      return;
    if (ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId)) return;
    if (viewport().key(editor_, press)) return;
    if (viewport().tool(editor_).busy()) return;  // no commands during a drag
    const bool letter = press.key >= 'A' && press.key <= 'Z';
    if (editor_.view.flying && plain && letter &&
        std::string_view("WASDQE").find(static_cast<char>(press.key)) != std::string_view::npos)
      return;
    const Command* command = command_for(press, editor_.settings);
    if (command == nullptr || (press.repeated && !command->repeats)) return;
    run_command(editor_, *command);
  }

  // Whether a dialog is open that needs an answer.
  bool asks() const {
    return editor_.dialogs.path != FileDialogPurpose::none || editor_.dialogs.quitting ||
           !editor_.project.recoverable.empty() || editor_.project.relinking.has_value() ||
           !editor_.project.to_open.empty();
  }

  void escape() {
    if (dialogs_.escape(editor_)) return;
    if (ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId)) {
      dialogs_.close_popups();  // a menu or a drop-down list
      return;
    }
    if (editor_.dialogs.palette || editor_.dialogs.keys) {
      editor_.dialogs.palette = editor_.dialogs.keys = false;
      return;
    }
    if (editor_.jobs.film) {
      editor_.messages.say(editor_.jobs.film->stopped());
      editor_.jobs.end_film();
      return;
    }
    if (viewport().tool(editor_).busy() && viewport().cancel(editor_)) return;
    if (!editor_.dialogs.form.empty()) {
      editor_.dialogs.form.clear();
      return;
    }
    if (editor_.dialogs.training) {
      editor_.dialogs.training = false;
      return;
    }
    if (viewport().cancel(editor_) || editor_.messages.close_failures()) return;
    if (editor_.jobs.worker.busy()) {
      editor_.jobs.worker.cancel();
    } else if (editor_.tools.kind != ToolKind::pick) {
      editor_.tools.kind = ToolKind::pick;
    } else {
      editor_.active.clear();
    }
  }

  // Applies theme, scale and fonts if they have changed.
  void apply_style() {
    const Settings& settings = editor_.settings;
    const bool dark = settings.looks == ColorTheme::dark || (settings.looks == ColorTheme::system && system_dark_);
    const AppliedStyle wanted{dark, window().scale() * settings.text_scale};
    if (applied_style_ == wanted) return;
    if (!applied_style_ || applied_style_->scale != wanted.scale) {
      load_fonts(static_cast<float>(wanted.scale));
      window().renew_fonts();
    }
    applied_style_ = wanted;
    scale_ = wanted.scale;
    set_style(dark ? dark_theme() : light_theme(), static_cast<float>(scale_));
  }

  void draw() {
    set_title();
    apply_style();
    window().begin_frame();
    ImGui::PushFont(fonts().text);
    layout_.draw(viewport(), window().moves());
    dialogs_.draw(editor_, viewport().thumbnails());
    ImGui::PopFont();
    window().end_frame();
    announce_state();
  }

  // Reports the state of the frame that was just drawn to test programs.
  void announce_state() {
    if (!announce::on()) return;
    nlohmann::json state;
    const bool working =
        !editor_.at_rest() || editor_.jobs.worker.busy() || editor_.previews.busy() || editor_.relighter.busy();
    state["settled"] = !working && !window().input_waits() && viewport().next_frame_in(editor_) < 0 && frames_ == 0;
    state["input"] = {{"keys", window().seen().keys},
                      {"buttons", window().seen().buttons},
                      {"text", window().seen().text},
                      {"wheel", window().seen().wheel},
                      {"pointer", {window().seen().x, window().seen().y}}};
    state["tool"] = command_of_tool(editor_.tools.kind);
    state["selected"] = editor_.selected_triangles();
    state["selected_words"] = editor_.selected_words();
    state["ground"] = editor_.scene().ground.height;
    if (!editor_.active.empty()) state["picked_foot"] = lowest_above({}, editor_.focus());
    state["steps"] = editor_.now->steps_done;
    state["status"] = editor_.status;
    state["preview"] = editor_.preview.has_value();
    state["scope"] = editor_.scope_words();
    state["picked"] = nlohmann::json::array();
    for (const NodeId id : editor_.active)
      if (const NodePtr node = find(editor_.scene(), id)) state["picked"].push_back(node->name);
    state["messages"] = nlohmann::json::array();
    for (const std::size_t k : editor_.messages.shown()) state["messages"].push_back(editor_.messages.log()[k].text);
    state["asks"] = asks();
    state["training"] = {{"runs", editor_.training.runs()}, {"triangles", trained_triangles()}};
    state["scale"] = scale_;
    state["window"] = {window().width(), window().height()};
    state["programs"] = {{"all_made", viewport().all_made()},
                         {"frames_waited", graphics_->renderer.compile_stall_count()}};
    state["longest_pause_ms"] = std::lround(longest_pause_ms_);
    announce::frame(state);
  }

  std::size_t trained_triangles() const { return editor_.beside ? editor_.beside->object->triangle_count() : 0; }

  static std::string command_of_tool(ToolKind kind) {
    for (const ToolButton& button : tool_buttons())
      if (button.kind == kind) return button.command;
    return "";
  }

  void set_title() {
    std::string title = "Rebake";
    if (!editor_.project.path.empty()) title = editor_.project.path.filename().string() + " - " + title;
    if (editor_.project.unsaved()) title = "* " + title;
    if (title != title_) window().set_title(title_ = title);
  }

  fs::path settings_file_;
  std::string settings_problem_;
  Settings saved_settings_;                    ///< settings as last written to disk
  Settings tried_settings_ = saved_settings_;  ///< settings that were written last, or could not be
  WindowSystem system_;
  Tools tools_;
  std::unique_ptr<Graphics> graphics_;
  std::vector<LostWork> lost_;  ///< found before this editor begins its own journal
  EditorContext editor_;
  WindowLayout layout_{editor_};
  Dialogs dialogs_;
  double scale_ = 1;  ///< framebuffer pixels per logical pixel: the monitor's scale × Settings::text_scale
  struct AppliedStyle {
    bool dark;
    double scale;
    bool operator==(const AppliedStyle&) const = default;
  };
  std::optional<AppliedStyle> applied_style_;  ///< theme and scale that are applied; empty: none yet
  bool system_dark_ = desktop_is_dark();       ///< the desktop's preference at the start
  int frames_ = 0;                             ///< number of frames still to be drawn after the last event
  double longest_pause_ms_ = 0;  ///< longest time between two frames that were due, since the last key press
  std::string title_;
  TrainingJob::State training_ = TrainingJob::State::none;  ///< in the last frame
};

}  // namespace

void run_editor(const std::vector<std::string>& paths) {
  // SIGINT and SIGTERM end the editor at once; the journal holds the work.
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
  EditorWindow(paths).run();
}

}  // namespace rebake
