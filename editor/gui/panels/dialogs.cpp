#include "editor/gui/panels/dialogs.h"

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_internal.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/fonts.h"
#include "editor/gui/ui/widgets.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

// Opens a modal dialog at the centre of the window. If this returns true, the caller must call ImGui::EndPopup().
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

// Answer buttons are right-aligned and equally wide.
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

}  // namespace

// Draws one journal: thumbnail, sources, number of steps, time, and its Recover and Discard buttons.
void Dialogs::draw_lost(Project& project, Thumbnails& thumbnails, const LostWork& work, bool first) {
  ImGui::PushID(work.journal.c_str());
  const ImVec2 size{px(96), px(60)};
  const unsigned picture = thumbnails.of_picture(thumbnail_path(work.journal));
  if (picture != 0) {
    ImGui::Image(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(picture)), size);
    announce::item("thumbnail");
  } else {
    ImGui::Dummy(size);
  }
  ImGui::SameLine();
  ImGui::BeginGroup();
  ImGui::TextUnformatted(ui::shortened(work.sources, px(400)).c_str());
  announce::item("sources: " + work.sources);
  ImGui::TextDisabled("%s", work.words().c_str());
  announce::item("words: " + work.words());
  if (first ? ui::primary_button("Recover##recover") : ui::button("Recover##recover")) chosen_ = work;
  if (!work.discarded) {
    ImGui::SameLine();
    if (ui::button("Discard...##ask-discard")) discarding_ = work;
    ui::tip("Discard", "", "Moves it to the trash after confirmation.");
  }
  ImGui::EndGroup();
  ImGui::PopID();
  if (!chosen_ || chosen_->journal != work.journal) return;
  try {
    project.recover(work.discarded ? restore(work) : work.journal);
  } catch (const fs::filesystem_error& error) {
    project.say_failed(error.path1().string() + ": " + error.code().message());
  }
}

void Dialogs::draw_recovery(Project& project, Thumbnails& thumbnails) {
  const bool discarded = project.recoverable.front().discarded;
  if (!begin_question(discarded ? "Discarded work" : "Recover unsaved work")) return;
  const announce::Part part("dialog");
  say(discarded ? fmt::format("Discarded work is deleted after {} days.", trash_days)
                : std::string("The editor closed without saving. Choose the work to recover:"));
  ImGui::BeginChild("list", {px(540), std::min(px(420), px(100) * static_cast<float>(project.recoverable.size()))});
  for (std::size_t k = 0; k < project.recoverable.size() && !chosen_; ++k)
    draw_lost(project, thumbnails, project.recoverable[k], k == 0);
  ImGui::EndChild();
  ImGui::Dummy({0, px(6)});
  const bool later = ui::button(discarded ? "Close" : "Later");
  if (!discarded) ui::tip("Later", "", "Asks again at the next start.");
  if (std::exchange(chosen_, std::nullopt) || later) {
    project.recoverable.clear();
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

void Dialogs::draw_discarding(Project& project) {
  if (!begin_question("Discard this work?")) return;
  const announce::Part part("dialog");
  say(fmt::format("{}: {}. It stays in the trash for {} days (File, Discarded work).", discarding_->sources,
                  discarding_->words(), trash_days));
  bool done = false;
  answers_right(2);
  if (ui::button("Discard##discard", answer_size())) {
    try {
      discard(*discarding_);
      std::erase_if(project.recoverable, [&](const LostWork& one) { return one.journal == discarding_->journal; });
    } catch (const fs::filesystem_error& error) {
      project.say_failed("Could not discard the work. " + error.path1().string() + ": " + error.code().message());
    }
    done = true;
  }
  ImGui::SameLine();
  if (ui::primary_button("Cancel##cancel", answer_size())) done = true;
  if (done) {
    discarding_.reset();
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

void Dialogs::draw_quitting(EditorContext& editor) {
  const bool busy = editor.jobs.worker.busy() || editor.jobs.film;
  // Edits that ended in this frame are seen in the next one.
  if (!busy && editor.now != editor.jobs.worker.snapshot()) return;
  if (!editor.project.unsaved() && !busy) {
    may_quit_ = true;
    return;
  }
  if (!begin_question("Save the changes before closing?")) return;
  const announce::Part part("dialog");
  say(busy ? "A job is still running."
           : "Unsaved changes will be lost" + (editor.project.path.empty()
                                                   ? std::string(".")
                                                   : " from " + editor.project.path.filename().string() + "."));
  answers_right(3);
  ImGui::BeginDisabled(busy);
  // Asks again if anything has been edited during the save.
  const auto quit = [&editor] { editor.dialogs.quitting = true; };
  if (ui::primary_button(editor.project.path.empty() ? "Save...##save" : "Save##save", answer_size())) {
    editor.dialogs.quitting = false;
    editor.project.after_save = quit;
    if (editor.project.path.empty())
      editor.dialogs.path = FileDialogPurpose::save_project;
    else
      editor.project.save(editor.project.path);
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndDisabled();
  ImGui::SameLine();
  if (ui::button("Don't save##do-not-save", answer_size())) may_quit_ = true;
  ImGui::SameLine();
  if (ui::button("Cancel##cancel", answer_size())) {
    editor.dialogs.quitting = false;
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

void Dialogs::draw_replacing(EditorContext& editor) {
  if (!begin_question("Save the changes before opening another project?")) return;
  const announce::Part part("dialog");
  Project& project = editor.project;
  say("Opening another project closes this one. Unsaved changes will be lost.");
  bool done = false;
  answers_right(3);
  if (ui::primary_button(project.path.empty() ? "Save...##save" : "Save##save", answer_size())) {
    // Asks again if anything has been edited during the save.
    project.after_save = [&project, paths = project.to_open] { project.open(paths); };
    if (project.path.empty())
      editor.dialogs.path = FileDialogPurpose::save_project;
    else
      project.save(project.path);
    done = true;
  }
  ImGui::SameLine();
  if (ui::button("Don't save##do-not-save", answer_size())) {
    project.open(project.to_open, true);
    done = true;
  }
  ImGui::SameLine();
  if (ui::button("Cancel##cancel", answer_size())) done = true;
  if (done) {
    project.to_open.clear();
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

void Dialogs::draw_relinking(Project& project) {
  if (!begin_question("Locate missing sources")) return;
  const announce::Part part("dialog");
  say(project.relinking->needed_by.filename().string() + " needs sources that are missing or changed:");
  for (Project::Relinking::Source& source : project.relinking->sources) {
    ImGui::PushID(source.path.c_str());
    ImGui::TextUnformatted((source.path.string() + " " + source.trouble).c_str());
    ImGui::SetNextItemWidth(px(540));
    ImGui::InputTextWithHint("##now", "New location of the folder", &source.now);
    announce::item(source.path.string());
    ImGui::PopID();
  }
  bool done = false;
  if (ui::primary_button("Try again")) {
    project.relink(false);
    done = true;
  }
  ImGui::SameLine();
  if (project.relinking && project.relinking->needed_by.extension() == ".journal") {
    if (ui::button("Continue without them")) {
      project.relink(true);
      done = true;
    }
    ImGui::SameLine();
  }
  if (ui::button("Cancel##cancel")) {
    project.relinking.reset();
    done = true;
  }
  if (done) ImGui::CloseCurrentPopup();
  ImGui::EndPopup();
}

bool Dialogs::escape(EditorContext& editor) {
  if (editor.dialogs.quitting)
    editor.dialogs.quitting = false;
  else if (!editor.project.to_open.empty())
    editor.project.to_open.clear();
  else if (editor.project.relinking)
    editor.project.relinking.reset();
  else if (discarding_)
    discarding_.reset();
  else if (!editor.project.recoverable.empty())
    editor.project.recoverable.clear();
  else if (files_.close_popup(editor))
    return true;
  else if (editor.dialogs.path != FileDialogPurpose::none)
    editor.dialogs.path = FileDialogPurpose::none;
  else
    return false;
  editor.project.after_save = nullptr;
  closes_ = true;
  return true;
}

// Draws only the most urgent dialog.
void Dialogs::draw(EditorContext& editor, Thumbnails& thumbnails) {
  if (std::exchange(closes_, false)) ImGui::ClosePopupsOverWindow(nullptr, false);
  if (editor.dialogs.quitting)
    draw_quitting(editor);
  else if (!editor.project.to_open.empty())
    draw_replacing(editor);
  else if (editor.project.relinking)
    draw_relinking(editor.project);
  else if (discarding_)
    draw_discarding(editor.project);
  else if (!editor.project.recoverable.empty())
    draw_recovery(editor.project, thumbnails);
  else
    files_.draw(editor, thumbnails);
}

}  // namespace rebake
