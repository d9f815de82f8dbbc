#include "editor/gui/panels/file_dialog.h"

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "editor/actions/picture_output.h"
#include "editor/document/replaced_work.h"
#include "editor/document/sample_folder.h"
#include "editor/edits/nodes/import.h"
#include "editor/edits/nodes/light.h"
#include "editor/edits/stored_view.h"
#include "editor/edits/support.h"
#include "editor/film/film_frames.h"
#include "editor/gui/panels/file_dialog_purpose.h"
#include "editor/gui/panels/light_model_form.h"
#include "editor/gui/state/navigation.h"
#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/fonts.h"
#include "editor/gui/ui/icons.h"
#include "editor/gui/ui/widgets.h"
#include "mesh_ops/base/child_process.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/formats.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

// Whether two paths lead to the same file, also if it does not exist.
bool is_same_file(const fs::path& a, const fs::path& b) {
  std::error_code error, other_error;
  if (a.empty() || b.empty()) return false;
  const fs::path first = fs::weakly_canonical(a, error), second = fs::weakly_canonical(b, other_error);
  return error || other_error ? a == b : first == second || fs::equivalent(a, b, error);
}

// The fields of an import that describe the folder.
std::vector<FieldInfo> import_fields() {
  std::vector<FieldInfo> fields = edit_type<Import>().fields();
  std::erase_if(fields, [](const FieldInfo& field) { return !describes_folder(field); });
  return fields;
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
  list.push_back({icons::folder_outline, "Working directory", fs::current_path(error)});
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

}  // namespace

std::vector<NodeRef> FileDialog::wanted_nodes(const EditorContext& editor) const {
  std::vector<NodeRef> nodes;
  if (only_picked_)
    for (const NodeId id : editor.active_tops()) nodes.push_back(NodeRef{id});
  return nodes;
}

void FileDialog::begin(const EditorContext& editor) {
  asked_ = editor.dialogs.path;
  only_picked_ = false;
  replacing_.clear();
  list_.look_at({}, "", true);
  video_ = false;
  export_.reset();
  import_ = {};
  width_ = editor.view.width;
  height_ = editor.view.height;
  std::error_code gone;
  const bool kept = editor.dialogs.path == FileDialogPurpose::save_project && !editor.project.path.empty();
  const fs::path last = reads(asked_) ? editor.settings.opened_from : editor.settings.written_to;
  const fs::path start = fs::is_directory(last, gone) ? last : fs::current_path(gone);
  path_ = kept ? editor.project.path.string() : (start / "").string();
  problem_.clear();
  if (kept || reads(asked_) || editor.scene().roots.empty()) return;
  // Suggest a name.
  const std::string title = editor.scene().roots.front()->name;
  const std::string ending = text_of(asked_).ending;
  if (asked_ == FileDialogPurpose::export_folder) path_ += title + "-edited";
  if (makes_film(asked_)) path_ += title + (asked_ == FileDialogPurpose::turntable ? "-turntable" : "-path");
  if (!ending.empty()) path_ += title + ending;
}

// Opens with the import options of the dialog. Throws FieldError for invalid ones.
void FileDialog::open_paths(EditorContext& editor, const std::vector<std::string>& paths) {
  nlohmann::json edit = import_.values();
  edit["op"] = Import::op;
  edit["path"] = paths.front();
  editor.project.open(paths, false, *read_edit(edit, editor.scene()).as<Import>());
}

void FileDialog::perform_action(EditorContext& editor, const fs::path& path) {
  if (makes_film(editor.dialogs.path) && editor.jobs.film)
    throw Error("another turntable or camera path is still being rendered; press Esc to cancel it");
  if (editor.dialogs.path != FileDialogPurpose::light_picture)
    (reads(editor.dialogs.path) ? editor.settings.opened_from : editor.settings.written_to) =
        path.parent_path().string();
  const Jobs::Rendered shows{editor.scene(), wanted_nodes(editor)};
  switch (editor.dialogs.path) {
    case FileDialogPurpose::open:
      if (list_.chosen().size() > 1)
        open_paths(editor, {list_.chosen().begin(), list_.chosen().end()});
      else
        open_paths(editor, {path.string()});
      break;
    case FileDialogPurpose::save_project:
      editor.project.save(path, replacing_ == path && !is_same_file(path, editor.project.path)
                                    ? Document::OtherProject::replace
                                    : Document::OtherProject::keep_more);
      break;
    case FileDialogPurpose::save_scene:
      editor.project.save_scene(path);
      break;
    case FileDialogPurpose::export_folder:
      editor.project.export_scene(export_.action(editor.scene(), wanted_nodes(editor), path));
      break;
    case FileDialogPurpose::web_page:
      editor.project.publish(path, editor.view.camera);
      break;
    case FileDialogPurpose::screenshot:
      refuse_replacing_work(path);
      refuse_replacing_unnamed(path, path);
      editor.jobs.screenshot = Jobs::Screenshot{path, width_, height_, shows};
      break;
    case FileDialogPurpose::turntable:
      editor.jobs.film.emplace(path, width_, height_, turntable(editor.view.camera, pictures_), editor.now->sources);
      editor.jobs.film_shows = shows;
      break;
    case FileDialogPurpose::camera_path: {
      std::vector<Camera> views;
      for (const std::string& name : view_names(editor.scene())) views.push_back(editor.scene().views.at(name));
      if (views.size() < 2) throw Error("a camera path needs at least two stored views; store another view first");
      editor.jobs.film.emplace(path, width_, height_, cameras_through(views, static_cast<std::size_t>(pictures_)),
                               editor.now->sources);
      editor.jobs.film_shows = shows;
      break;
    }
    case FileDialogPurpose::save_script:
      editor.project.save_script(path);
      break;
    case FileDialogPurpose::light_picture: {
      LightEdit edit = light_edit(editor.scene().light ? *editor.scene().light : SceneLight{}, editor.scene());
      edit.source = "picture";
      edit.picture = path.string();
      edit.content.clear();
      editor.edit_light(edit);
      break;
    }
    case FileDialogPurpose::light_model:
      use_light_model_of(editor, path.string());
      break;
    case FileDialogPurpose::photographs:
      editor.dialogs.photographs = path.string();
      break;
    default:
      editor.project.run_script(path);
  }
}

// Buttons left of the answers that open the desktop's own file dialog.
void FileDialog::draw_desktop_buttons(const EditorContext& editor, const std::string& ending) {
  if (!DesktopFileDialog::there()) return;
  using Kind = DesktopFileDialog::Kind;
  const FileDialogText& question = text_of(editor.dialogs.path);
  const auto offer = [&](const std::string& label, const char* id, Kind kind, const char* help,
                         const std::string& files) {
    ImGui::BeginDisabled(desktop_ != nullptr);
    if (ui::button((label + "##" + id).c_str())) try {
        desktop_ = std::make_unique<DesktopFileDialog>(kind, question.title, path_, files);
      } catch (const Error& failed) {
        problem_path_ = path_;
        problem_ = failed.what();
      }
    ImGui::EndDisabled();
    ui::tip(label, "", help);
    ImGui::SameLine();
  };
  if (editor.dialogs.path == FileDialogPurpose::open) {
    offer("Folders...", "folders", Kind::open_folders, "Opens the desktop's file dialog to choose scenes.", "");
    offer("Project...", "project", Kind::open_file, "Opens the desktop's file dialog to choose a project.", ".rebake");
  } else {
    offer("Browse...", "browse",
          reads(editor.dialogs.path) ? Kind::open_file
          : ending.empty()           ? Kind::save_folder
                                     : Kind::save_file,
          "Opens the desktop's file dialog.", ending);
  }
}

void FileDialog::take_answer(EditorContext& editor) {
  if (!desktop_) return;
  const std::optional<std::vector<std::string>> paths = desktop_->answer();
  if (!paths) return;
  desktop_.reset();
  refocus_path_ = true;
  if (paths->empty()) return;
  path_ = paths->front();
  if (editor.dialogs.path != FileDialogPurpose::open) return;
  editor.settings.opened_from = fs::path(path_).parent_path().string();
  editor.dialogs.path = FileDialogPurpose::none;
  try {
    open_paths(editor, *paths);
  } catch (const std::exception& failed) {
    editor.messages.fail(failed.what());
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

namespace {

// Opens the dialog's popup in the middle of the window. Returns false if it is not drawn.
bool begin_popup(const std::string& title) {
  // Another dialog may have closed the popup.
  if (!ImGui::IsPopupOpen("###path")) ImGui::OpenPopup("###path");
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  const ImVec2 size{std::min(px(760), screen.x - px(20)), std::min(px(520), screen.y - px(20))};
  ImGui::SetNextWindowSize(size);
  ImGui::SetNextWindowPos({screen.x / 2, screen.y / 2}, ImGuiCond_Always, {0.5F, 0.5F});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {px(18), px(16)});
  const bool begun = ImGui::BeginPopupModal((title + "###path").c_str(), nullptr,
                                            ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize |
                                                ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings);
  ImGui::PopStyleVar();
  return begun;
}

void draw_places(const Settings& settings, std::string& path, float height) {
  ImGui::BeginChild("places", {px(180), height}, true);
  for (const Bookmark& place : bookmarks(settings)) {
    if (ImGui::Selectable(fmt::format("{}  {}", place.icon, ui::shortened(place.name, px(130))).c_str()))
      path = place.path.string() + "/";
    announce::item(place.name);
    ui::tip(place.path.string());
  }
  ImGui::EndChild();
}

}  // namespace

FileDialog::Form FileDialog::form_for(const EditorContext& editor) {
  Form form;
  form.exports = editor.dialogs.path == FileDialogPurpose::export_folder;
  form.opens = editor.dialogs.path == FileDialogPurpose::open;
  form.film = makes_film(editor.dialogs.path);
  form.pictures = form.film || editor.dialogs.path == FileDialogPurpose::screenshot;
  form.writes = !reads(editor.dialogs.path);
  form.ending = form.film && video_ ? ".mp4" : text_of(editor.dialogs.path).ending;
  if (form.exports && !export_.format().is_folder) form.ending = export_.format().marker;
  form.endings = form.ending == text_of(editor.dialogs.path).ending ? listed_endings(editor.dialogs.path) : form.ending;
  // If all top-level nodes are picked, the option would change nothing.
  form.offers_picked = (form.pictures || form.exports) && !editor.active.empty() &&
                       editor.active_tops().size() < editor.scene().roots.size();
  only_picked_ = only_picked_ && form.offers_picked;
  if (form.exports) form.lost = export_.losses(with_only(editor.scene(), wanted_nodes(editor)));
  return form;
}

// Draws the path field. Returns whether the user confirmed it.
bool FileDialog::draw_path() {
  if (ImGui::IsWindowAppearing() || std::exchange(refocus_path_, false)) ImGui::SetKeyboardFocusHere();
  ImGui::SetNextItemWidth(-1);
  const bool done = ImGui::InputText("##text", &path_,
                                     ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_CallbackCompletion |
                                         ImGuiInputTextFlags_CallbackHistory,
                                     on_key, this);
  announce::item("path");
  if (list_.chosen().size() > 1 && !list_.chosen().contains(path_)) list_.clear_choice();
  return done;
}

// Draws bookmarks and the folder's entries. Returns whether the user chose one by a double click.
bool FileDialog::draw_entries(const EditorContext& editor, Thumbnails& thumbnails, const Form& form) {
  const auto rows =
      1.0F + static_cast<float>(int{form.pictures} + int{form.offers_picked} + int{form.exports || form.opens});
  float below = ImGui::GetFrameHeightWithSpacing() * rows + ImGui::GetTextLineHeightWithSpacing();
  for (const std::string& line : form.lost)
    below += ImGui::CalcTextSize(("•  " + line).c_str(), nullptr, false, ImGui::GetContentRegionAvail().x).y +
             ImGui::GetStyle().ItemSpacing.y;
  const float height = std::max(px(80), ImGui::GetContentRegionAvail().y - below);
  const fs::path typed(path_);
  ImGui::PushStyleColor(ImGuiCol_ChildBg, color(theme().field));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {px(8), px(6)});
  draw_places(editor.settings, path_, height);
  ImGui::SameLine();
  ImGui::BeginChild("entries", {0, height}, true);
  // "a/b" for "a/b/"
  list_.look_at(typed.parent_path(), form.endings);
  // Filter only when reading: a path to be written is usually a new name.
  list_.filter(form.writes ? "" : typed.filename().string());
  bool done = false;
  if (const FolderList::Taken taken = list_.draw(thumbnails, form.opens, form.opens); !taken.path.empty()) {
    path_ = taken.path.string();
    done = taken.at_once;
  }
  ImGui::EndChild();
  ImGui::PopStyleVar();
  ImGui::PopStyleColor();
  return done;
}

void FileDialog::draw_export_options(EditorContext& editor, const Form& form) {
  if (form.offers_picked) {
    ui::toggle("Only the picked nodes##only-picked", only_picked_);
    ImGui::SameLine();
    ImGui::TextDisabled("%s", editor.scope_words().c_str());
  }
  if (form.exports) export_.draw(editor, wanted_nodes(editor), problem_);
  if (form.opens)
    import_options_.draw(editor, "How MobileNeRF folders of other tools are read.", import_fields(), import_, problem_);
  for (const std::string& line : form.lost) ui::muted("•  " + line);
}

void FileDialog::draw_picture_options(const Form& form) {
  const auto pixels = [](const char* label, int& value, int least, int most) {
    ImGui::SetNextItemWidth(px(90));
    ImGui::InputInt(label, &value, 0);
    announce::item(label);
    value = std::clamp(value, least, most);
  };
  pixels("wide", width_, 16, 8192);
  ImGui::SameLine();
  pixels("high, pixels", height_, 16, 8192);
  if (!form.film) return;
  ImGui::SameLine();
  pixels("pictures", pictures_, 2, 1000);
  ImGui::SameLine();
  const bool can = !program_path("ffmpeg").empty();
  ImGui::BeginDisabled(!can);
  const bool was = video_;
  ui::toggle("Video##video", video_);
  ImGui::EndDisabled();
  ui::tip("Video", "",
          can ? fmt::format("Writes an MP4 file with {} frames per second.", CameraAnimation::rate)
              : std::string("Needs ffmpeg. Install it to write videos."));
  if (was && !video_ && path_.ends_with(".mp4")) path_.resize(path_.size() - 4);
}

// Sets problem_ to the reason why the path cannot be used; empty if it can.
void FileDialog::check_path(const EditorContext& editor, const fs::path& path, const Form& form) {
  problem_path_ = path_;
  problem_ = problem_with(path, editor.dialogs.path);
  // Check for protected sources before asking whether to replace a file.
  if (!problem_.empty() || !form.writes) return;
  try {
    if (form.ending.empty())
      editor.now->sources.check_folder(path);
    else
      editor.now->sources.check_file(path);
  } catch (const Error& refused) {
    problem_ = refused.what();
  }
}

// Checks the path and performs the action. Returns false if the dialog stays open.
bool FileDialog::confirm(EditorContext& editor, const fs::path& path, const Form& form, bool replaces) {
  refocus_path_ = true;
  check_path(editor, path, form);
  if (!problem_.empty()) return false;
  if (replaces && replacing_ != path) {
    replacing_ = path;
    return false;
  }
  try {
    perform_action(editor, path);
  } catch (const std::exception& failed) {
    problem_ = failed.what();
    return false;
  }
  refocus_path_ = false;
  return true;
}

void FileDialog::draw(EditorContext& editor, Thumbnails& thumbnails) {
  take_answer(editor);
  if (editor.dialogs.path == FileDialogPurpose::none) {
    asked_ = FileDialogPurpose::none;
    export_.leave();
    import_options_.leave();
    desktop_.reset();
    return;
  }
  const FileDialogText& question = text_of(editor.dialogs.path);
  if (asked_ != editor.dialogs.path) begin(editor);
  if (!begin_popup(question.title)) return;
  const announce::Part part("dialog");
  ImGui::PushFont(fonts().heading);
  ImGui::TextUnformatted(question.title);
  ImGui::PopFont();
  ImGui::SameLine(0, px(12));
  ImGui::TextDisabled("%s", question.hint);
  bool done = draw_path();
  const Form form = form_for(editor);
  done = draw_entries(editor, thumbnails, form) || done;
  draw_export_options(editor, form);
  if (form.pictures) draw_picture_options(form);
  fs::path path(path_);
  if (!path.has_filename()) path = path.parent_path();
  if (!form.ending.empty() && !has_ending(path, form.endings)) path += form.ending;
  std::error_code error;
  const bool filled = fs::is_directory(path, error) && !fs::is_empty(path, error);
  const bool replaces = form.writes && path != editor.project.path && (fs::is_regular_file(path, error) || filled);
  const bool asks = replaces && replacing_ == path;
  if (asks)
    ui::wrapped(path.filename().string() + " already exists. Press Enter or the button to replace it.", theme().danger);
  else if (!problem_.empty() && problem_path_ == path_) {
    ui::wrapped(problem_, theme().danger);
    announce::item("problem");
  } else
    ImGui::TextUnformatted("");
  draw_desktop_buttons(editor, form.ending);
  const float width = px(120);
  ImGui::SetCursorPosX(ImGui::GetWindowContentRegionMax().x - 2 * width - ImGui::GetStyle().ItemSpacing.x);
  const bool cancelled = ui::button("Cancel##cancel", {width, 0});
  ImGui::SameLine();
  const std::size_t several = form.opens ? list_.chosen().size() : 1;
  const std::string action = asks ? "Replace" : several > 1 ? fmt::format("Open {}", several) : question.action;
  done = ui::primary_button((action + "##confirm").c_str(), {width, 0}) || done;
  if (done) done = confirm(editor, path, form, replaces);
  export_.draw_comparison(editor.jobs);
  if (cancelled) editor.project.after_save = nullptr;
  if (done || cancelled) {
    editor.dialogs.path = FileDialogPurpose::none;
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

}  // namespace rebake
