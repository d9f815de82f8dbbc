#include "editor/gui/panels/file_dialog.h"

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <utility>

#include "editor/document/sample_folder.h"
#include "editor/edits/nodes/light.h"
#include "editor/edits/stored_view.h"
#include "editor/edits/support.h"
#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/fonts.h"
#include "editor/gui/ui/icons.h"
#include "editor/gui/ui/widgets.h"
#include "editor/gui/view/navigation.h"
#include "editor/gui/window/child_process.h"
#include "mesh_ops/base/error.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

struct Question {
  PathQuestion kind;
  const char* title;
  const char* hint;
  const char* action;           ///< label of the primary button
  const char* ending;           ///< extension added to names without it; empty for folders and for reading
  const char* listed = ending;  ///< extensions of the listed files, separated by spaces
};
constexpr Question questions[] = {
    {PathQuestion::open, "Open", "A baked scene, a scene folder, or a project (.rebake).", "Open", "", ".rebake"},
    {PathQuestion::save_project, "Save project", "A file that keeps all steps.", "Save", ".rebake"},
    {PathQuestion::save_scene, "Save scene folder", "A folder that keeps every node, not the steps.", "Save", ""},
    {PathQuestion::export_folder, "Export", "A folder that MobileNeRF viewers open.", "Export", ""},
    {PathQuestion::screenshot, "Screenshot", "A PNG file of the scene, without grid and handles.", "Write", ".png"},
    {PathQuestion::turntable, "Turntable", "A folder for pictures from all around: 000.png, 001.png, …", "Write", ""},
    {PathQuestion::camera_path, "Camera path", "A folder for pictures on a way through the stored views.", "Write", ""},
    {PathQuestion::save_script, "Save as script", "A file with a line an edit.", "Save", ".jsonl"},
    {PathQuestion::run_script, "Run script", "A file with a line an edit.", "Run", ".jsonl"},
    {PathQuestion::light_picture, "Picture of light", "All directions in one picture, twice as wide as high.", "Take",
     "", ".exr .hdr .png .jpg .jpeg .tif .tiff"},
};

const Question& question_of(PathQuestion kind) {
  for (const Question& question : questions)
    if (question.kind == kind) return question;
  return questions[0];
}

bool reads(PathQuestion asked) {
  return asked == PathQuestion::open || asked == PathQuestion::run_script || asked == PathQuestion::light_picture;
}

// Checks a path before it is used. Returns an error message; empty if the path is usable.
std::string problem_with(const fs::path& path, PathQuestion asked) {
  const bool writes = !reads(asked);
  std::error_code error;
  if (path.empty()) return "Type or choose a path.";
  const fs::path parent = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (writes && !fs::is_directory(parent, error)) return "There is no folder " + parent.string() + ".";
  if (!writes && !fs::exists(path, error)) return "There is nothing at " + path.string() + ".";
  if (asked == PathQuestion::light_picture)
    return fs::is_regular_file(path, error) ? "" : path.filename().string() + " is not a file.";
  if (!writes && fs::is_directory(path, error) && !holds_scene(path))
    return path.filename().string() + " holds no scene that can be read.";
  return "";
}

bool makes_film(PathQuestion asked) { return asked == PathQuestion::turntable || asked == PathQuestion::camera_path; }

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

// Lines of text about everything that an export of this scene loses.
std::vector<std::string> losses(const Scene& scene, bool plain) {
  std::vector<std::string> lines;
  std::size_t objects = 0, hidden = 0, turned = 0;
  for (const PlacedNode& placed : placed_nodes(scene)) {
    if (!placed.node->object) continue;
    placed.visible ? ++objects : ++hidden;
    if (placed.visible && placed.node->object->any_rotations()) ++turned;
  }
  if (plain) lines.emplace_back("one decoder is fitted to all of it; the messages say what that costs in dB");
  if (objects > 1 && !plain)
    lines.push_back(
        fmt::format("{} objects: one folder holds one decoder; those that do not fit together become a "
                    "scene folder (scene.json), which only Rebake opens",
                    objects));
  if (hidden > 0)
    lines.push_back(hidden == 1 ? std::string("1 hidden object is left out")
                                : fmt::format("{} hidden objects are left out", hidden));
  if (turned > 0 && !plain)
    lines.push_back(
        fmt::format("{} bent: the plain format keeps places, not turned view directions; the messages "
                    "say what that costs in dB",
                    turned == 1 ? std::string("1 object is") : fmt::format("{} objects are", turned)));
  lines.emplace_back("names, groups, stored views and history are not in the plain format");
  return lines;
}

}  // namespace

std::vector<NodeRef> FileDialog::wanted_nodes(const Desk& desk) const {
  std::vector<NodeRef> nodes;
  if (only_picked_)
    for (const NodeId id : desk.active_tops()) nodes.push_back(NodeRef{id});
  return nodes;
}

void FileDialog::begin(const Desk& desk) {
  asked_ = desk.asking.path;
  only_picked_ = false;
  replacing_.clear();
  list_.look_at({}, "", true);
  video_ = false;
  preview_.forget();
  width_ = desk.view.width;
  height_ = desk.view.height;
  std::error_code gone;
  const bool kept = desk.asking.path == PathQuestion::save_project && !desk.project.path.empty();
  const fs::path last = reads(asked_) ? desk.settings.opened_from : desk.settings.written_to;
  const fs::path start = fs::is_directory(last, gone) ? last : fs::current_path(gone);
  path_ = kept ? desk.project.path.string() : (start / "").string();
  problem_.clear();
  if (kept || reads(asked_) || desk.scene().roots.empty()) return;
  // Suggest a name.
  const std::string title = desk.scene().roots.front()->name;
  const std::string ending = question_of(asked_).ending;
  if (asked_ == PathQuestion::export_folder) path_ += title + "-edited";
  if (makes_film(asked_)) path_ += title + (asked_ == PathQuestion::turntable ? "-turntable" : "-path");
  if (!ending.empty()) path_ += title + ending;
}

void FileDialog::carry_out(Desk& desk, const fs::path& path) {
  if (makes_film(desk.asking.path) && desk.jobs.film) throw Error("a film is still being made; Esc ends it");
  if (desk.asking.path != PathQuestion::light_picture)
    (reads(desk.asking.path) ? desk.settings.opened_from : desk.settings.written_to) = path.parent_path().string();
  if (makes_film(desk.asking.path) || desk.asking.path == PathQuestion::screenshot)
    desk.jobs.pictured = wanted_nodes(desk);
  switch (desk.asking.path) {
    case PathQuestion::open:
      if (list_.chosen().size() > 1) {
        std::vector<std::string> several;
        for (const fs::path& one : list_.chosen()) several.push_back(one.string());
        desk.project.open(several);
      } else {
        desk.project.open({path.string()});
      }
      break;
    case PathQuestion::save_project:
      desk.project.save(path);
      break;
    case PathQuestion::save_scene:
      desk.project.save_scene(path);
      break;
    case PathQuestion::export_folder:
      desk.project.export_to(path, wanted_nodes(desk), plain_ ? std::optional(preview_.choice()) : std::nullopt);
      break;
    case PathQuestion::screenshot:
      desk.jobs.screenshot = Jobs::Screenshot{path, width_, height_};
      break;
    case PathQuestion::turntable:
      desk.jobs.film.emplace(path, width_, height_, turntable(desk.view.camera, pictures_), desk.now->sources);
      break;
    case PathQuestion::camera_path: {
      std::vector<Camera> views;
      for (const std::string& name : view_names(desk.scene())) views.push_back(desk.scene().views.at(name));
      if (views.size() < 2) throw Error("a path needs two stored views or more");
      desk.jobs.film.emplace(path, width_, height_, camera_path(views, pictures_), desk.now->sources);
      break;
    }
    case PathQuestion::save_script:
      desk.project.save_script(path);
      break;
    case PathQuestion::light_picture: {
      LightEdit edit = light_edit(desk.scene().light ? *desk.scene().light : SceneLight{});
      edit.source = "picture";
      edit.picture = path.string();
      edit.content.clear();
      desk.edit(edit);
      break;
    }
    default:
      desk.project.run_script(path);
  }
}

// Buttons left of the answers that open the desktop's own file dialog.
void FileDialog::draw_desktop_buttons(const Desk& desk, const std::string& ending) {
  if (!DesktopFileDialog::there()) return;
  using Kind = DesktopFileDialog::Kind;
  const Question& question = question_of(desk.asking.path);
  const auto offer = [&](const char* label, Kind kind, const char* help, const std::string& files) {
    ImGui::BeginDisabled(desktop_ != nullptr);
    if (ui::button(label)) try {
        desktop_ = std::make_unique<DesktopFileDialog>(kind, question.title, path_, files);
      } catch (const Error& failed) {
        problem_of_ = path_;
        problem_ = failed.what();
      }
    ImGui::EndDisabled();
    ui::tip(label, "", help);
    ImGui::SameLine();
  };
  if (desk.asking.path == PathQuestion::open) {
    offer("Folders...", Kind::open_folders, "The desktop's dialog, for scenes.", "");
    offer("Project...", Kind::open_file, "The desktop's dialog, for a project.", ".rebake");
  } else {
    offer("Browse...",
          reads(desk.asking.path) ? Kind::open_file
          : ending.empty()        ? Kind::save_folder
                                  : Kind::save_file,
          "The desktop's dialog.", ending);
  }
}

void FileDialog::take_answer(Desk& desk) {
  if (!desktop_) return;
  const std::optional<std::vector<std::string>> paths = desktop_->answer();
  if (!paths) return;
  desktop_.reset();
  refocuses_ = true;
  if (paths->empty()) return;
  path_ = paths->front();
  if (desk.asking.path != PathQuestion::open) return;
  desk.settings.opened_from = fs::path(path_).parent_path().string();
  desk.asking.path = PathQuestion::none;
  try {
    desk.project.open(*paths);
  } catch (const std::exception& failed) {
    desk.messages.fail(failed.what());
  }
}

// Keys in the path field: Tab completes the name, the up and down keys step through the list.
int FileDialog::on_key(ImGuiInputTextCallbackData* data) {
  auto& self = *static_cast<FileDialog*>(data->UserData);
  const fs::path typed(data->Buf);
  std::string text;
  if (data->EventFlag == ImGuiInputTextFlags_CallbackCompletion)
    text = (typed.parent_path() / self.list_.completed(typed.filename().string())).string();
  else if (const fs::path next = self.list_.step(data->EventKey == ImGuiKey_UpArrow ? -1 : 1); !next.empty())
    text = next.string();
  if (text.empty()) return 0;
  data->DeleteChars(0, data->BufTextLen);
  data->InsertChars(0, text.c_str());
  return 0;
}

void FileDialog::draw(Desk& desk, Thumbnails& thumbnails) {
  take_answer(desk);
  if (desk.asking.path == PathQuestion::none) {
    asked_ = PathQuestion::none;
    desktop_.reset();
    return;
  }
  const Question& question = question_of(desk.asking.path);
  if (asked_ != desk.asking.path) begin(desk);
  // Another dialog may have closed the popup.
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
  bool done = ImGui::InputText("##text", &path_,
                               ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_CallbackCompletion |
                                   ImGuiInputTextFlags_CallbackHistory,
                               on_key, this);
  announce::item("path");
  const bool exports = desk.asking.path == PathQuestion::export_folder;
  const bool opens = desk.asking.path == PathQuestion::open, film = makes_film(desk.asking.path);
  if (list_.chosen().size() > 1 && !list_.chosen().contains(path_)) list_.choose_none();
  const fs::path typed(path_);
  std::error_code error;
  const fs::path folder = typed.parent_path();  // "a/b" for "a/b/"
  const bool pictures = film || desk.asking.path == PathQuestion::screenshot;
  const std::string ending = film && video_ ? ".mp4" : question.ending;
  // If all top-level nodes are picked, the option would change nothing.
  const bool offers_picked = (pictures || desk.asking.path == PathQuestion::export_folder) && !desk.active.empty() &&
                             desk.active_tops().size() < desk.scene().roots.size();
  only_picked_ = only_picked_ && offers_picked;
  const std::vector<std::string> lost = desk.asking.path == PathQuestion::export_folder
                                            ? losses(with_only(desk.scene(), wanted_nodes(desk)), plain_)
                                            : std::vector<std::string>{};
  float below = ImGui::GetFrameHeightWithSpacing() *
                    (1.0F + (pictures ? 1.0F : 0.0F) + (offers_picked ? 1.0F : 0.0F) + (exports ? 1.0F : 0.0F)) +
                ImGui::GetTextLineHeightWithSpacing();
  for (const std::string& line : lost)
    below += ImGui::CalcTextSize(("•  " + line).c_str(), nullptr, false, ImGui::GetContentRegionAvail().x).y +
             ImGui::GetStyle().ItemSpacing.y;
  const float high = std::max(px(80), ImGui::GetContentRegionAvail().y - below);
  ImGui::PushStyleColor(ImGuiCol_ChildBg, color(theme().field));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {px(8), px(6)});
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
  list_.look_at(folder, ending.empty() ? question.listed : ending);
  // Filter only when reading: a path to be written is usually a new name.
  list_.filter(reads(desk.asking.path) ? typed.filename().string() : "");
  if (const FolderList::Taken taken = list_.draw(thumbnails, opens, opens); !taken.path.empty()) {
    path_ = taken.path.string();
    done = done || taken.at_once;
  }
  ImGui::EndChild();
  ImGui::PopStyleVar();
  ImGui::PopStyleColor();
  if (offers_picked) {
    ui::toggle("Only the picked nodes", only_picked_);
    ImGui::SameLine();
    ImGui::TextDisabled("%s", desk.scope_words().c_str());
  }
  if (exports) {
    ui::toggle("One plain folder", plain_);
    ui::tip("One plain folder", "",
            "That any MobileNeRF viewer shows: several decoders, turned and bent parts in one.");
    if (plain_) {
      ImGui::SameLine();
      if (ui::button("Compare...")) preview_.begin(desk, wanted_nodes(desk));
      ui::tip("Compare...", "", "What each width of the decoder costs and shows, before anything is written.");
      ui::hint(preview_.words());
    }
  }
  for (const std::string& line : lost) ui::muted("•  " + line);
  if (pictures) {
    const auto pixels = [](const char* label, int& value, int least, int most) {
      ImGui::SetNextItemWidth(px(90));
      ImGui::InputInt(label, &value, 0);
      announce::item(label);
      value = std::clamp(value, least, most);
    };
    pixels("wide", width_, 16, 8192);
    ImGui::SameLine();
    pixels("high, pixels", height_, 16, 8192);
    if (film) {
      ImGui::SameLine();
      pixels("pictures", pictures_, 2, 1000);
      ImGui::SameLine();
      const bool can = !program_path("ffmpeg").empty();
      ImGui::BeginDisabled(!can);
      const bool was = video_;
      ui::toggle("Video", video_);
      ImGui::EndDisabled();
      ui::tip("Video", "",
              can ? fmt::format("An MP4 file of {} pictures a second.", Film::rate)
                  : std::string("Needs the program ffmpeg."));
      if (was && !video_ && path_.ends_with(".mp4")) path_.resize(path_.size() - 4);
    }
  }
  fs::path path(path_);
  if (!path.has_filename()) path = path.parent_path();
  if (!ending.empty() && path.extension() != ending) path += ending;
  const bool writes = !reads(desk.asking.path);
  const bool filled = fs::is_directory(path, error) && !fs::is_empty(path, error);
  const bool replaces = writes && path != desk.project.path && (fs::is_regular_file(path, error) || filled);
  const bool asks = replaces && replacing_ == path;
  if (asks)
    ui::wrapped(path.filename().string() + " is there already. Replace it? Enter or the button does.", theme().danger);
  else if (!problem_.empty() && problem_of_ == path_) {
    ui::wrapped(problem_, theme().danger);
    announce::item("problem");
  } else
    ImGui::TextUnformatted("");
  draw_desktop_buttons(desk, ending);
  const float width = px(120);
  ImGui::SetCursorPosX(ImGui::GetWindowContentRegionMax().x - 2 * width - ImGui::GetStyle().ItemSpacing.x);
  const bool cancelled = ui::button("Cancel", {width, 0});
  ImGui::SameLine();
  const std::size_t several = opens ? list_.chosen().size() : 1;
  const std::string action = asks ? "Replace" : several > 1 ? fmt::format("Open {}", several) : question.action;
  done = ui::primary_button(action.c_str(), {width, 0}) || done;
  if (done) {
    problem_of_ = path_;
    problem_ = problem_with(path, desk.asking.path);
    // Check for protected sources before asking whether to replace a file.
    if (problem_.empty() && writes) try {
        const bool file = !ending.empty();
        file ? desk.now->sources.check_file(path) : desk.now->sources.check_folder(path);
      } catch (const Error& refused) {
        problem_ = refused.what();
      }
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
  if (done) try {
      carry_out(desk, path);
    } catch (const std::exception& failed) {
      problem_of_ = path_;
      problem_ = failed.what();
      done = false;
      refocuses_ = true;
    }
  preview_.draw(desk);
  if (cancelled) desk.project.saved_then = nullptr;
  if (done || cancelled) {
    desk.asking.path = PathQuestion::none;
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

}  // namespace rebake
