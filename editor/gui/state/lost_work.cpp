#include "editor/gui/state/lost_work.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <system_error>

#include "editor/document/journal.h"
#include "editor/gui/state/settings.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/formats.h"
#include "render/image.h"

namespace rebake {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

fs::path trash_folder() { return journal_folder().parent_path() / "trash"; }

// Adds the names of the scenes that a journal entry imports, without duplicates.
void add_sources(const json& entry, std::vector<std::string>& names) {
  const auto add = [&](const json& edit) {
    if (edit.value("op", "") != "import" || !edit.contains("path")) return;
    const std::string name = folder_title(edit.at("path").get<std::string>());
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  if (entry.contains("edit")) add(entry.at("edit"));
  if (entry.contains("edits"))
    for (const json& edit : entry.at("edits")) add(edit);
}

std::string joined(const std::vector<std::string>& names) {
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
  return all.empty() ? "an empty scene" : all;
}

// Work in a folder, without journals that are in use or empty.
std::vector<LostWork> work_in(const fs::path& folder, bool discarded) {
  std::vector<LostWork> found;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    const fs::path& path = at->path();
    if (path.extension() != ".journal" || Journal::in_use(path)) continue;
    LostWork work;
    work.journal = path;
    work.discarded = discarded;
    std::error_code unknown;
    const fs::file_time_type written = fs::last_write_time(path, unknown);
    if (!unknown)
      work.changed =
          std::chrono::time_point_cast<std::chrono::system_clock::duration>(std::chrono::file_clock::to_sys(written));
    try {
      const Journal::Contents contents = Journal::read(path);
      if (contents.entries.empty() && contents.damaged_line == 0 && !contents.torn) {
        // Deletes empty journals, but not new ones: another editor may just be starting.
        if (!unknown && fs::file_time_type::clock::now() - written > std::chrono::minutes(1)) fs::remove(path, unknown);
        continue;
      }
      std::vector<std::string> names;
      for (const std::string& text : contents.entries) add_sources(json::parse(text), names);
      work.sources = joined(names);
      work.steps = steps_done(contents).lines.size();
    } catch (const std::exception& problem) {
      work.sources = problem.what();
    }
    found.push_back(std::move(work));
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.changed > b.changed; });
  return found;
}

// Deletes the files of a folder for which `is_stale` returns true.
template <class IsStale>
void sweep(const fs::path& folder, IsStale is_stale) {
  std::vector<fs::path> stale;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error))
    if (is_stale(at->path())) stale.push_back(at->path());
  for (const fs::path& path : stale) fs::remove(path, error);
}

// Deletes work that was discarded more than trash_days ago; discard() sets the file time.
void empty_trash() {
  sweep(trash_folder(), [now = fs::file_time_type::clock::now()](const fs::path& path) {
    std::error_code unknown;
    const fs::file_time_type discarded = fs::last_write_time(path, unknown);
    return !unknown && path.extension() == ".journal" && Journal::is_journal(path) &&
           now - discarded > std::chrono::days(trash_days) && !Journal::in_use(path);
  });
}

void forget_thumbnails_without_journal() {
  sweep(thumbnail_path("x").parent_path(), [](const fs::path& path) {
    std::error_code unknown;
    return path.extension() == ".png" && path.stem().extension() == ".journal" && is_rendered_picture(path) &&
           !fs::exists(journal_folder() / path.stem(), unknown) && !fs::exists(trash_folder() / path.stem(), unknown);
  });
}

// Moves a journal to a folder and returns its path there, with a number if the name is taken.
fs::path move_journal(const fs::path& journal, const fs::path& folder) {
  fs::path place = folder / journal.filename();
  for (int k = 2; fs::exists(fs::symlink_status(place)); ++k)
    place = folder / fmt::format("{}-{}.journal", journal.stem().string(), k);
  fs::rename(journal, place);
  return place;
}

}  // namespace

std::string LostWork::words() const {
  return fmt::format("{} step{}, {:%e %B %Y, %H:%M}", steps, steps == 1 ? "" : "s",
                     fmt::localtime(std::chrono::system_clock::to_time_t(changed)));
}

fs::path thumbnail_path(const fs::path& journal) {
  return journal_folder().parent_path() / "thumbnails" / (journal.filename().string() + ".png");
}

std::vector<LostWork> lost_work() {
  empty_trash();
  forget_thumbnails_without_journal();
  return work_in(journal_folder(), false);
}

std::vector<LostWork> discarded_work() { return work_in(trash_folder(), true); }

void discard(const LostWork& work) {
  if (Journal::in_use(work.journal))
    throw fs::filesystem_error("discard", work.journal, std::make_error_code(std::errc::device_or_resource_busy));
  fs::create_directories(trash_folder());
  // The days in the trash are counted from this time.
  fs::last_write_time(work.journal, fs::file_time_type::clock::now());
  move_journal(work.journal, trash_folder());
}

fs::path restore(const LostWork& work) {
  fs::create_directories(journal_folder());
  return move_journal(work.journal, journal_folder());
}

}  // namespace rebake
