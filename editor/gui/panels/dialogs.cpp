#include <fmt/format.h>
#include <imgui.h>
#include <imgui_internal.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <utility>

#include "editor/document/sample_folder.h"
#include "editor/gui/panels/panels.h"
#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/fonts.h"
#include "editor/gui/ui/icons.h"
#include "editor/gui/ui/widgets.h"
#include "mesh_ops/formats/formats.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

struct Question {
  PathQuestion kind;
  const char* title;
  const char* hint;
  const char* action;  ///< of its primary button
  const char* ending;  ///< that a file's name gets where it has none
};
constexpr Question questions[] = {
    {PathQuestion::open, "Open", "A baked scene, a scene folder, or a project (.rebake).", "Open", ""},
    {PathQuestion::save_project, "Save project", "A file that keeps all steps.", "Save", ".rebake"},
    {PathQuestion::save_scene, "Save scene folder", "A folder that keeps every node, not the steps.", "Save", ""},
    {PathQuestion::export_folder, "Export", "A folder that MobileNeRF viewers open.", "Export", ""},
    {PathQuestion::screenshot, "Screenshot", "A PNG file of the scene, without grid and handles.", "Write", ".png"},
    {PathQuestion::turntable, "Turntable", "A folder for pictures from all around: 000.png, 001.png, …", "Write", ""},
    {PathQuestion::save_script, "Save as script", "A file with a line an edit.", "Save", ".jsonl"},
    {PathQuestion::run_script, "Run script", "A file with a line an edit.", "Run", ".jsonl"},
};

const Question& question_of(PathQuestion kind) {
  for (const Question& question : questions)
    if (question.kind == kind) return question;
  return questions[0];
}

// In the middle, wherever it stood before.
bool begin_question(const char* title) {
  if (!ImGui::IsPopupOpen(title)) ImGui::OpenPopup(title);
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({screen.x / 2, screen.y / 2}, ImGuiCond_Always, {0.5F, 0.5F});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {px(18), px(16)});
  const bool open = ImGui::BeginPopupModal(title, nullptr,
                                           ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove |
                                               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoSavedSettings);
  ImGui::PopStyleVar();
  if (!open) return false;
  ImGui::PushFont(fonts().heading);
  ImGui::TextUnformatted(title);
  ImGui::PopFont();
  ImGui::Dummy({px(360), px(2)});
  return true;
}

// Answers stand at the right, as wide as each other.
ImVec2 answer_size() { return {px(110), 0}; }
void answers_right(int count) {
  const float all =
      static_cast<float>(count) * answer_size().x + static_cast<float>(count - 1) * ImGui::GetStyle().ItemSpacing.x;
  ImGui::SetCursorPosX(std::max(ImGui::GetCursorPosX(), ImGui::GetWindowContentRegionMax().x - all));
}

void say(const std::string& text) {
  ImGui::PushTextWrapPos(px(520));
  ImGui::PushStyleColor(ImGuiCol_Text, color(theme().muted));
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopStyleColor();
  ImGui::PopTextWrapPos();
  ImGui::Dummy({0, px(4)});
}

// Whether some format knows the folder.
bool holds_scene(const fs::path& folder) {
  const auto known = formats();
  try {
    return std::any_of(known.begin(), known.end(), [&](const Format& format) { return format.recognises(folder); });
  } catch (const fs::filesystem_error&) {
    return false;  // it may not be looked into
  }
}

// What is wrong with a path before anything is tried, empty for nothing.
std::string problem_with(const fs::path& path, bool writes) {
  std::error_code error;
  if (path.empty()) return "Type or choose a path.";
  const fs::path parent = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (writes && !fs::is_directory(parent, error)) return "There is no folder " + parent.string() + ".";
  if (!writes && !fs::exists(path, error)) return "There is nothing at " + path.string() + ".";
  if (!writes && fs::is_directory(path, error) && !holds_scene(path))
    return path.filename().string() + " holds no scene that can be read.";
  return "";
}

struct Bookmark {
  const char* icon;
  std::string name;
  fs::path path;
};
std::vector<Bookmark> bookmarks(const Settings& settings) {
  std::vector<Bookmark> list;
  std::error_code error;
  if (const char* home = std::getenv("HOME")) list.push_back({icons::home, "Home", home});
  list.push_back({icons::folder_outline, "Where it was started", fs::current_path(error)});
  if (const fs::path samples = sample_folder(); !samples.empty())
    list.push_back({icons::cube_outline, "Samples", samples});
  std::set<fs::path> seen;
  for (const std::string& recent : settings.recent) {
    const fs::path folder = fs::path(recent).parent_path();
    if (seen.size() < 5 && seen.insert(folder).second)
      list.push_back({icons::history, folder.filename().string(), folder});
  }
  return list;
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
  if (hidden > 0)
    lines.push_back(hidden == 1 ? std::string("1 hidden object is left out")
                                : fmt::format("{} hidden objects are left out", hidden));
  if (turned > 0)
    lines.push_back(
        fmt::format("{} bent: the plain format keeps places, not turned view directions; the messages "
                    "say what that costs in dB",
                    turned == 1 ? std::string("1 object is") : fmt::format("{} objects are", turned)));
  lines.emplace_back("names, groups, stored views and history are not in the plain format");
  return lines;
}

}  // namespace

void Dialogs::begin_path(const Desk& desk) {
  asked_ = desk.asking.path;
  replacing_.clear();
  entries_of_.clear();
  width_ = desk.view.width;
  height_ = desk.view.height;
  std::error_code gone;
  const bool kept = desk.asking.path == PathQuestion::save_project && !desk.project.path.empty();
  const bool reads = asked_ == PathQuestion::open || asked_ == PathQuestion::run_script;
  const fs::path last = reads ? desk.settings.opened_from : desk.settings.written_to;
  const fs::path start = fs::is_directory(last, gone) ? last : fs::current_path(gone);
  path_ = kept ? desk.project.path.string() : (start / "").string();
  problem_.clear();
  if (kept || reads || desk.scene().roots.empty()) return;
  // A name to begin with.
  const std::string title = desk.scene().roots.front()->name;
  const std::string ending = question_of(asked_).ending;
  if (asked_ == PathQuestion::export_folder) path_ += title + "-edited";
  if (!ending.empty()) path_ += title + ending;
}

// What lies in the folder that is typed; true when something of it is to be taken at once.
bool Dialogs::draw_entries(const Desk& desk, const fs::path& folder, const std::string& ending) {
  std::error_code error;
  if (entries_of_ != folder) {
    entries_of_ = folder;
    entries_.clear();
    for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
      if (at->path().filename().string().starts_with('.')) continue;
      std::error_code unknown;
      const bool is_folder = at->is_directory(unknown);
      entries_.push_back({at->path(), is_folder, is_folder && holds_scene(at->path())});
    }
    std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) {
      return std::pair(!a.is_folder, a.path) < std::pair(!b.is_folder, b.path);
    });
  }
  bool taken = false;
  const bool opens = desk.asking.path == PathQuestion::open;
  const announce::Part part("entries");
  if (ImGui::Selectable((std::string(icons::arrow_up) + "  ..").c_str(), false))
    path_ = (folder / "..").lexically_normal().string();
  announce::item("..");
  for (const Entry& entry : entries_) {
    const std::string name = entry.path.filename().string();
    const std::string wanted = opens ? ".rebake" : ending;
    if (!entry.is_folder && (wanted.empty() || entry.path.extension() != wanted)) continue;
    const char* icon = entry.is_scene    ? icons::cube_outline
                       : entry.is_folder ? icons::folder_outline
                                         : icons::file_outline;
    ImGui::PushStyleColor(ImGuiCol_Text, color(entry.is_folder && !entry.is_scene ? theme().muted : theme().text));
    const bool chosen = fs::path(path_) == entry.path;
    const bool clicked =
        ImGui::Selectable(fmt::format("{}  {}", icon, name).c_str(), chosen, ImGuiSelectableFlags_AllowDoubleClick);
    ImGui::PopStyleColor();
    announce::item(name);
    if (!clicked) continue;
    const bool enters = entry.is_folder && !(entry.is_scene && opens);
    path_ = entry.path.string() + (enters ? "/" : "");
    taken = !enters && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left);
  }
  return taken;
}

void Dialogs::carry_out(Desk& desk, const fs::path& path) {
  const bool reads = desk.asking.path == PathQuestion::open || desk.asking.path == PathQuestion::run_script;
  (reads ? desk.settings.opened_from : desk.settings.written_to) = path.parent_path().string();
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

void Dialogs::draw_path(Desk& desk) {
  if (desk.asking.path == PathQuestion::none) {
    asked_ = PathQuestion::none;
    return;
  }
  const Question& question = question_of(desk.asking.path);
  if (asked_ != desk.asking.path) begin_path(desk);
  // Another question may have closed it meanwhile.
  if (!ImGui::IsPopupOpen("###path")) ImGui::OpenPopup("###path");
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  const ImVec2 size{std::min(px(760), screen.x - px(20)), std::min(px(520), screen.y - px(20))};
  ImGui::SetNextWindowSize(size);
  ImGui::SetNextWindowPos({screen.x / 2, screen.y / 2}, ImGuiCond_Always, {0.5F, 0.5F});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {px(18), px(16)});
  const bool begun = ImGui::BeginPopupModal((std::string(question.title) + "###path").c_str(), nullptr,
                                            ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize |
                                                ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings);
  ImGui::PopStyleVar();
  if (!begun) return;
  const announce::Part part("dialog");
  ImGui::PushFont(fonts().heading);
  ImGui::TextUnformatted(question.title);
  ImGui::PopFont();
  ImGui::SameLine(0, px(12));
  ImGui::TextDisabled("%s", question.hint);
  if (ImGui::IsWindowAppearing() || std::exchange(refocuses_, false)) ImGui::SetKeyboardFocusHere();
  ImGui::SetNextItemWidth(-1);
  bool done = ImGui::InputText("##text", &path_, ImGuiInputTextFlags_EnterReturnsTrue);
  announce::item("path");
  const fs::path typed(path_);
  std::error_code error;
  const fs::path folder = typed.has_filename() ? typed.parent_path() : typed;
  const bool pictures = desk.asking.path == PathQuestion::screenshot || desk.asking.path == PathQuestion::turntable;
  const std::vector<std::string> lost =
      desk.asking.path == PathQuestion::export_folder ? losses(desk.scene()) : std::vector<std::string>{};
  float below = ImGui::GetFrameHeightWithSpacing() * (pictures ? 2.0F : 1.0F) + ImGui::GetTextLineHeightWithSpacing();
  for (const std::string& line : lost)
    below += ImGui::CalcTextSize(("•  " + line).c_str(), nullptr, false, ImGui::GetContentRegionAvail().x).y +
             ImGui::GetStyle().ItemSpacing.y;
  const float high = std::max(px(80), ImGui::GetContentRegionAvail().y - below);
  ImGui::PushStyleColor(ImGuiCol_ChildBg, color(theme().field));
  ImGui::BeginChild("places", {px(180), high}, true);
  for (const Bookmark& place : bookmarks(desk.settings)) {
    if (ImGui::Selectable(fmt::format("{}  {}", place.icon, ui::shortened(place.name, px(130))).c_str()))
      path_ = place.path.string() + "/";
    announce::item(place.name);
    ui::tip(place.path.string());
  }
  ImGui::EndChild();
  ImGui::SameLine();
  ImGui::BeginChild("entries", {0, high}, true);
  done = draw_entries(desk, folder, question.ending) || done;
  ImGui::EndChild();
  ImGui::PopStyleColor();
  for (const std::string& line : lost) ui::muted("•  " + line);
  if (pictures) {
    const auto pixels = [](const char* label, int& value, int least, int most) {
      ImGui::SetNextItemWidth(px(90));
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
  fs::path path(path_);
  if (!path.has_filename()) path = path.parent_path();
  if (question.ending[0] != '\0' && path.extension() != question.ending) path += question.ending;
  const bool writes = desk.asking.path != PathQuestion::open && desk.asking.path != PathQuestion::run_script;
  const bool filled = fs::is_directory(path, error) && !fs::is_empty(path, error);
  const bool replaces = writes && path != desk.project.path && (fs::is_regular_file(path, error) || filled);
  const bool asks = replaces && replacing_ == path;
  if (asks)
    ui::wrapped(path.filename().string() + " is there already. Replace it? Enter or the button does.", theme().danger);
  else if (!problem_.empty() && problem_of_ == path_)
    ui::wrapped(problem_, theme().danger);
  else
    ImGui::TextUnformatted("");
  const float width = px(120);
  ImGui::SetCursorPosX(ImGui::GetWindowContentRegionMax().x - 2 * width - ImGui::GetStyle().ItemSpacing.x);
  const bool cancelled = ui::button("Cancel", {width, 0});
  ImGui::SameLine();
  done = ui::primary_button(asks ? "Replace" : question.action, {width, 0}) || done;
  if (done) {
    problem_of_ = path_;
    problem_ = problem_with(path, writes);
    if (!problem_.empty()) {
      done = false;
      refocuses_ = true;
    }
  }
  if (done && replaces && !asks) {
    replacing_ = path;
    done = false;
    refocuses_ = true;
  }
  if (done) carry_out(desk, path);
  if (cancelled) desk.project.saved_then = nullptr;
  if (done || cancelled) {
    desk.asking.path = PathQuestion::none;
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

void Dialogs::draw_recovery(Project& project) {
  if (!begin_question("Work was not saved")) return;
  const announce::Part part("dialog");
  say("The editor ended without saving. This work can be got back:");
  bool done = false, first = true;
  for (const Project::LostWork& lost : project.recoverable) {
    ImGui::PushID(lost.journal.c_str());
    const bool pressed = first ? ui::primary_button("Recover") : ui::button("Recover");
    first = false;
    if (pressed) {
      project.recover(lost.journal);
      done = true;
    }
    ImGui::SameLine();
    ImGui::TextUnformatted(lost.what.c_str());
    ImGui::PopID();
  }
  ImGui::Dummy({0, px(6)});
  if (ui::button("Later")) done = true;
  ui::tip("Later", "", "It is asked again when the editor starts.");
  ImGui::SameLine();
  if (ui::button("Delete all of it")) {
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
  if (!begin_question("Save the changes before closing?")) return;
  const announce::Part part("dialog");
  const bool busy = desk.jobs.worker.busy();
  say(busy ? "Something is still being done."
           : "Changes that are not saved are lost" + (desk.project.path.empty()
                                                          ? std::string(".")
                                                          : " from " + desk.project.path.filename().string() + "."));
  answers_right(3);
  ImGui::BeginDisabled(busy);
  const auto quit = [this] { may_quit_ = true; };
  if (ui::primary_button(desk.project.path.empty() ? "Save..." : "Save", answer_size())) {
    desk.asking.quitting = false;
    desk.project.saved_then = quit;
    if (desk.project.path.empty())
      desk.asking.path = PathQuestion::save_project;
    else
      desk.project.save(desk.project.path);
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndDisabled();
  ImGui::SameLine();
  if (ui::button("Don't save", answer_size())) may_quit_ = true;
  ImGui::SameLine();
  if (ui::button("Cancel", answer_size())) {
    desk.asking.quitting = false;
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

void Dialogs::draw_replacing(Desk& desk) {
  if (!begin_question("Save the changes before opening another project?")) return;
  const announce::Part part("dialog");
  Project& project = desk.project;
  say("Another project takes the place of this one. Changes that are not saved are lost.");
  bool done = false;
  answers_right(3);
  if (ui::primary_button(project.path.empty() ? "Save..." : "Save", answer_size())) {
    project.saved_then = [&project, paths = project.to_open] { project.open(paths, true); };
    if (project.path.empty())
      desk.asking.path = PathQuestion::save_project;
    else
      project.save(project.path);
    done = true;
  }
  ImGui::SameLine();
  if (ui::button("Don't save", answer_size())) {
    project.open(project.to_open, true);
    done = true;
  }
  ImGui::SameLine();
  if (ui::button("Cancel", answer_size())) done = true;
  if (done) {
    project.to_open.clear();
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

void Dialogs::draw_relinking(Project& project) {
  if (!begin_question("Where are the sources now?")) return;
  const announce::Part part("dialog");
  say(project.relinking->wanted_by.filename().string() + " needs what is not as it was:");
  for (Project::Relinking::Source& source : project.relinking->sources) {
    ImGui::PushID(source.path.c_str());
    ImGui::TextUnformatted((source.path.string() + " " + source.trouble).c_str());
    ImGui::SetNextItemWidth(px(540));
    ImGui::InputTextWithHint("##now", "The folder where it lies now", &source.now);
    announce::item(source.path.string());
    ImGui::PopID();
  }
  bool done = false;
  if (ui::primary_button("Try again")) {
    project.relink(false);
    done = true;
  }
  ImGui::SameLine();
  if (project.relinking && project.relinking->wanted_by.extension() == ".journal") {
    if (ui::button("Go on without them")) {
      project.relink(true);
      done = true;
    }
    ImGui::SameLine();
  }
  if (ui::button("Cancel")) {
    project.relinking.reset();
    done = true;
  }
  if (done) ImGui::CloseCurrentPopup();
  ImGui::EndPopup();
}

bool Dialogs::escape(Desk& desk) {
  if (desk.asking.quitting)
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
  desk.project.saved_then = nullptr;
  closes_ = true;
  return true;
}

// One at a time, the most urgent first.
void Dialogs::draw(Desk& desk) {
  if (std::exchange(closes_, false)) ImGui::ClosePopupsOverWindow(nullptr, false);
  if (desk.asking.quitting)
    draw_quitting(desk);
  else if (!desk.project.to_open.empty())
    draw_replacing(desk);
  else if (desk.project.relinking)
    draw_relinking(desk.project);
  else if (!desk.project.recoverable.empty())
    draw_recovery(desk.project);
  else
    draw_path(desk);
}

}  // namespace rebake
