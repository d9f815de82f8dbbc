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
  const unsigned picture = thumbnails.of_picture(thumbnail_file(work.journal));
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
  if (first ? ui::primary_button("Recover") : ui::button("Recover")) chosen_ = work;
  if (!work.discarded) {
    ImGui::SameLine();
    if (ui::button("Discard...")) discarding_ = work;
    ui::tip("Discard", "", "Moves it to the trash, after a question.");
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
  if (!begin_question(discarded ? "Discarded work" : "Work was not saved")) return;
  const announce::Part part("dialog");
  say(discarded ? fmt::format("Discarded work stays here for {} days.", trash_days)
                : std::string("An editor ended without saving. Choose what to recover:"));
  ImGui::BeginChild("list", {px(540), std::min(px(420), px(100) * static_cast<float>(project.recoverable.size()))});
  for (std::size_t k = 0; k < project.recoverable.size() && !chosen_; ++k)
    draw_lost(project, thumbnails, project.recoverable[k], k == 0);
  ImGui::EndChild();
  ImGui::Dummy({0, px(6)});
  const bool later = ui::button(discarded ? "Close" : "Later");
  if (!discarded) ui::tip("Later", "", "The editor asks again when it starts.");
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
  if (ui::button("Discard", answer_size())) {
    try {
      discard(*discarding_);
      std::erase_if(project.recoverable, [&](const LostWork& one) { return one.journal == discarding_->journal; });
    } catch (const fs::filesystem_error& error) {
      project.say_failed("The work was not discarded. " + error.path1().string() + ": " + error.code().message());
    }
    done = true;
  }
  ImGui::SameLine();
  if (ui::primary_button("Cancel", answer_size())) done = true;
  if (done) {
    discarding_.reset();
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

void Dialogs::draw_quitting(Desk& desk) {
  if (!desk.project.unsaved() && !desk.jobs.worker.busy() && !desk.jobs.film) {
    may_quit_ = true;
    return;
  }
  if (!begin_question("Save the changes before closing?")) return;
  const announce::Part part("dialog");
  const bool busy = desk.jobs.worker.busy() || desk.jobs.film;
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
  else if (discarding_)
    discarding_.reset();
  else if (!desk.project.recoverable.empty())
    desk.project.recoverable.clear();
  else if (files_.leaves_comparing(desk))
    return true;
  else if (desk.asking.path != PathQuestion::none)
    desk.asking.path = PathQuestion::none;
  else
    return false;
  desk.project.saved_then = nullptr;
  closes_ = true;
  return true;
}

// Draws only the most urgent dialog.
void Dialogs::draw(Desk& desk, Thumbnails& thumbnails) {
  if (std::exchange(closes_, false)) ImGui::ClosePopupsOverWindow(nullptr, false);
  if (desk.asking.quitting)
    draw_quitting(desk);
  else if (!desk.project.to_open.empty())
    draw_replacing(desk);
  else if (desk.project.relinking)
    draw_relinking(desk.project);
  else if (discarding_)
    draw_discarding(desk.project);
  else if (!desk.project.recoverable.empty())
    draw_recovery(desk.project, thumbnails);
  else
    files_.draw(desk, thumbnails);
}

}  // namespace rebake
