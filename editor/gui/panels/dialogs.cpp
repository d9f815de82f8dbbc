#include <fmt/format.h>
#include <imgui.h>
#include <imgui_internal.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "editor/gui/panels/panels.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

struct Question {
  PathQuestion kind;
  const char* title;
  const char* hint;
  const char* ending;  ///< that a file's name gets where it has none
};
constexpr Question questions[] = {
    {PathQuestion::open, "Open", "a MobileNeRF folder, a scene folder, or a project (.rebake)", ""},
    {PathQuestion::save_project, "Save project", "a file; it remembers all edits", ".rebake"},
    {PathQuestion::save_scene, "Save scene folder", "a folder; keeps every node, not the history", ""},
    {PathQuestion::export_folder, "Export", "a folder in the MobileNeRF format", ""},
    {PathQuestion::screenshot, "Screenshot", "a PNG file of the scene, without grid and handles", ".png"},
    {PathQuestion::turntable, "Turntable", "a folder for pictures from around the target: 000.png, 001.png, ...", ""},
    {PathQuestion::save_script, "Save as script", "a file with a line an edit", ".jsonl"},
    {PathQuestion::run_script, "Run script", "a file with a line an edit", ".jsonl"},
};

const Question& question_of(PathQuestion kind) {
  for (const Question& question : questions)
    if (question.kind == kind) return question;
  return questions[0];
}

bool entered() { return ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Enter), false); }

// In the middle, wherever it stood before.
bool begin_question(const char* title) {
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({screen.x / 2, screen.y / 2}, ImGuiCond_Always, {0.5F, 0.5F});
  return ImGui::BeginPopupModal(title, nullptr, ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove);
}

// What the format cannot keep of this scene.
std::vector<std::string> losses(const Scene& scene) {
  std::vector<std::string> lines;
  std::size_t objects = 0, hidden = 0, turned = 0;
  for (const PlacedNode& placed : placed_nodes(scene)) {
    if (!placed.node->object) continue;
    placed.visible ? ++objects : ++hidden;
    if (placed.visible && placed.node->object->any_rotations()) ++turned;
  }
  if (objects > 1)
    lines.push_back(
        fmt::format("{} objects: one folder holds one decoder; those that do not fit together become a "
                    "scene folder (scene.json)",
                    objects));
  if (hidden > 0) lines.push_back(fmt::format("{} hidden objects are left out", hidden));
  if (turned > 0)
    lines.push_back(
        fmt::format("{} bent or turned objects: the plain format keeps places, not turned view directions; "
                    "the log says what that costs in dB",
                    turned));
  lines.emplace_back("names, groups, stored views and history are not in the plain format");
  return lines;
}

}  // namespace

void Dialogs::draw_path(Desk& desk) {
  if (desk.asking.path == PathQuestion::none) {
    asked_ = PathQuestion::none;
    return;
  }
  const Question& question = question_of(desk.asking.path);
  const bool first = asked_ != desk.asking.path;
  if (first) {
    asked_ = desk.asking.path;
    replacing_.clear();
    width_ = desk.view.width;
    height_ = desk.view.height;
    std::error_code gone;
    path_ = desk.asking.path == PathQuestion::save_project && !desk.project.path.empty()
                ? desk.project.path.string()
                : fs::current_path(gone).string() + "/";
  }
  // Another question may have closed it meanwhile.
  if (!ImGui::IsPopupOpen("###path")) ImGui::OpenPopup("###path");
  ImGui::SetNextWindowSize({620, 420}, ImGuiCond_Appearing);
  bool open = true;
  if (!ImGui::BeginPopupModal((std::string(question.title) + "###path").c_str(), &open)) {
    if (!open) desk.asking.path = PathQuestion::none;
    return;
  }
  if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
  ImGui::TextDisabled("%s", question.hint);
  ImGui::SetNextItemWidth(-1);
  bool done = ImGui::InputText("##text", &path_, ImGuiInputTextFlags_EnterReturnsTrue);
  const fs::path typed(path_);
  std::error_code error;
  const fs::path folder = fs::is_directory(typed, error) ? typed : typed.parent_path();
  const bool pictures = desk.asking.path == PathQuestion::screenshot || desk.asking.path == PathQuestion::turntable;
  const bool roomy = desk.asking.path != PathQuestion::export_folder && !pictures;
  ImGui::BeginChild("entries", {0, roomy ? 290.0F : 200.0F}, true);
  if (ImGui::Selectable("..")) path_ = (folder / "..").lexically_normal().string();
  std::vector<fs::path> entries;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error))
    entries.push_back(at->path());
  std::sort(entries.begin(), entries.end());
  for (const fs::path& entry : entries) {
    const bool is_folder = fs::is_directory(entry, error);
    if (entry.filename().string().starts_with('.')) continue;
    const bool fits = is_folder || question.ending[0] == '\0' ? is_folder || entry.extension() == ".rebake"
                                                              : entry.extension() == question.ending;
    if (!fits) continue;
    if (ImGui::Selectable((entry.filename().string() + (is_folder ? "/" : "")).c_str()))
      path_ = entry.string() + (is_folder ? "/" : "");
  }
  if (desk.asking.path == PathQuestion::open)
    for (const std::string& recent : desk.settings.recent) {
      if (ImGui::Selectable(fmt::format("recent: {}", recent).c_str())) path_ = recent;
    }
  ImGui::EndChild();
  if (desk.asking.path == PathQuestion::export_folder)
    for (const std::string& line : losses(desk.scene())) ImGui::TextWrapped("- %s", line.c_str());
  if (pictures) {
    const auto pixels = [](const char* label, int& value, int least, int most) {
      ImGui::SetNextItemWidth(110);
      ImGui::InputInt(label, &value, 0);
      value = std::clamp(value, least, most);
    };
    pixels("wide", width_, 16, 8192);
    ImGui::SameLine();
    pixels("high, pixels", height_, 16, 8192);
    if (desk.asking.path == PathQuestion::turntable) {
      ImGui::SameLine();
      pixels("pictures", pictures_, 2, 1000);
    }
  }
  done = ImGui::Button(question.title) || done;
  ImGui::SameLine();
  const bool cancelled = ImGui::Button("Cancel") || !open;
  fs::path path(path_);
  if (!path.has_filename()) path = path.parent_path();
  if (question.ending[0] != '\0' && path.extension() != question.ending) path += question.ending;
  const bool writes = desk.asking.path != PathQuestion::open && desk.asking.path != PathQuestion::run_script;
  const bool filled = fs::is_directory(path, error) && !fs::is_empty(path, error);
  const bool replaces = writes && path != desk.project.path && (fs::is_regular_file(path, error) || filled);
  if (done && replaces && replacing_ != path) {
    replacing_ = path;
    done = false;
    ImGui::SetKeyboardFocusHere(-1);
  }
  if (replaces && replacing_ == path)
    ImGui::TextColored({1, 0.5F, 0.4F, 1}, "%s is there already: once more to replace it", path.filename().c_str());
  if (done && !path_.empty()) {
    switch (desk.asking.path) {
      case PathQuestion::open:
        desk.project.open({path.string()});
        break;
      case PathQuestion::save_project:
        desk.project.save(path);
        break;
      case PathQuestion::save_scene:
        desk.project.save_scene(path);
        break;
      case PathQuestion::export_folder:
        desk.project.export_to(path);
        break;
      case PathQuestion::screenshot:
        desk.jobs.screenshot = Jobs::Screenshot{path, width_, height_};
        break;
      case PathQuestion::turntable:
        desk.jobs.turntable = Jobs::Turntable{path, width_, height_, pictures_};
        break;
      case PathQuestion::save_script:
        desk.project.save_script(path);
        break;
      default:
        desk.project.run_script(path);
    }
  }
  if (done || cancelled) {
    desk.asking.path = PathQuestion::none;
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

void Dialogs::draw_error(Messages& messages) {
  const char* const title = "It could not be done";
  if (!ImGui::IsPopupOpen(title)) ImGui::OpenPopup(title);
  if (!begin_question(title)) return;
  ImGui::PushTextWrapPos(520);
  ImGui::TextUnformatted(messages.error.c_str());
  ImGui::PopTextWrapPos();
  if (ImGui::Button("OK") || entered()) {
    messages.error.clear();
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

void Dialogs::draw_recovery(Project& project) {
  const char* const title = "Unsaved work";
  if (!ImGui::IsPopupOpen(title)) ImGui::OpenPopup(title);
  if (!begin_question(title)) return;
  ImGui::TextUnformatted("The editor ended without saving. Its work can be got back:");
  bool done = false;
  for (const Project::LostWork& lost : project.recoverable) {
    ImGui::PushID(lost.journal.c_str());
    if (ImGui::Button("Recover")) {
      project.recover(lost.journal);
      done = true;
    }
    ImGui::SameLine();
    ImGui::TextUnformatted(lost.what.c_str());
    ImGui::PopID();
  }
  if (ImGui::Button("Later")) done = true;
  ImGui::SameLine();
  if (ImGui::Button("Drop all of it")) {
    for (const Project::LostWork& lost : project.recoverable) {
      std::error_code ignored;
      fs::remove(lost.journal, ignored);
    }
    done = true;
  }
  if (done) {
    project.recoverable.clear();
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

void Dialogs::draw_quitting(Desk& desk) {
  if (!desk.project.unsaved() && !desk.jobs.worker.busy()) {
    may_quit_ = true;
    return;
  }
  const char* const title = "Unsaved changes";
  if (!ImGui::IsPopupOpen(title)) ImGui::OpenPopup(title);
  if (!begin_question(title)) return;
  ImGui::TextUnformatted(desk.jobs.worker.busy() ? "Something is still being done."
                                                 : "There are changes that no project holds yet.");
  if (ImGui::Button(desk.project.path.empty() ? "Save..." : "Save and quit")) {
    if (desk.project.path.empty()) {
      desk.asking.quitting = false;
      desk.asking.path = PathQuestion::save_project;
      ImGui::CloseCurrentPopup();
    } else {
      desk.project.save(desk.project.path);
    }
  }
  ImGui::SameLine();
  if (ImGui::Button("Quit without saving")) may_quit_ = true;
  ImGui::SameLine();
  if (ImGui::Button("Go on")) {
    desk.asking.quitting = false;
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

void Dialogs::draw_replacing(Project& project) {
  const char* const title = "Open another project";
  if (!ImGui::IsPopupOpen(title)) ImGui::OpenPopup(title);
  if (!begin_question(title)) return;
  ImGui::TextUnformatted("There are changes that no project holds yet; opening another project drops them.");
  const bool drops = ImGui::Button("Drop them and open");
  ImGui::SameLine();
  if (drops) project.open(project.to_open, true);
  if (ImGui::Button("Go on") || drops) {
    project.to_open.clear();
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

void Dialogs::draw_relinking(Project& project) {
  const char* const title = "Where are the sources now?";
  if (!ImGui::IsPopupOpen(title)) ImGui::OpenPopup(title);
  if (!begin_question(title)) return;
  ImGui::PushTextWrapPos(560);
  ImGui::Text("%s wants what is not as it was:", project.relinking->wanted_by.filename().c_str());
  for (Project::Relinking::Source& source : project.relinking->sources) {
    ImGui::PushID(source.path.c_str());
    ImGui::TextUnformatted((source.path.string() + " " + source.trouble).c_str());
    ImGui::SetNextItemWidth(540);
    ImGui::InputTextWithHint("##now", "the folder where it lies now", &source.now);
    ImGui::PopID();
  }
  ImGui::PopTextWrapPos();
  bool done = false;
  if (ImGui::Button("Try again")) {
    project.relink(false);
    done = true;
  }
  ImGui::SameLine();
  if (project.relinking && project.relinking->wanted_by.extension() == ".journal") {
    if (ImGui::Button("Go on without them")) {
      project.relink(true);
      done = true;
    }
    ImGui::SameLine();
  }
  if (ImGui::Button("Cancel")) {
    project.relinking.reset();
    done = true;
  }
  if (done) ImGui::CloseCurrentPopup();
  ImGui::EndPopup();
}

bool Dialogs::escape(Desk& desk) {
  if (!desk.messages.error.empty())
    desk.messages.error.clear();
  else if (desk.asking.quitting)
    desk.asking.quitting = false;
  else if (!desk.project.to_open.empty())
    desk.project.to_open.clear();
  else if (desk.project.relinking)
    desk.project.relinking.reset();
  else if (!desk.project.recoverable.empty())
    desk.project.recoverable.clear();
  else if (desk.asking.path != PathQuestion::none)
    desk.asking.path = PathQuestion::none;
  else
    return false;
  closes_ = true;
  return true;
}

// One at a time, the most urgent first.
void Dialogs::draw(Desk& desk) {
  if (std::exchange(closes_, false)) ImGui::ClosePopupsOverWindow(nullptr, false);
  if (!desk.messages.error.empty())
    draw_error(desk.messages);
  else if (desk.asking.quitting)
    draw_quitting(desk);
  else if (!desk.project.to_open.empty())
    draw_replacing(desk.project);
  else if (desk.project.relinking)
    draw_relinking(desk.project);
  else if (!desk.project.recoverable.empty())
    draw_recovery(desk.project);
  else
    draw_path(desk);
}

}  // namespace rebake
