#include "editor/document/document.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "editor/document/project.h"
#include "editor/document/replaced_work.h"
#include "mesh_ops/base/counted.h"
#include "mesh_ops/base/file_lock.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/base/hash.h"

namespace rebake {

using nlohmann::json;
namespace fs = std::filesystem;

namespace {

// One journal line for all edits of a step: a torn journal contains all of them or none.
json entry_of(const std::vector<Edit>& edits, std::size_t replaced = 0) {
  json entry;
  if (edits.size() == 1)
    entry["edit"] = to_json(edits.front());
  else
    for (const Edit& edit : edits) entry["edits"].push_back(to_json(edit));
  if (replaced > 0) entry["replaces"] = replaced;
  return entry;
}

// Journals of earlier versions write `true` for 1.
std::size_t count_in(const json& value) { return value.is_boolean() ? 1 : value.get<std::size_t>(); }

}  // namespace

Document::Document(Scene start, std::uint64_t memory_budget)
    : starts_empty_(start.roots.empty()), history_(std::move(start), memory_budget) {}

Document Document::open(const fs::path& project, const SourceLinks& links, const Progress& progress,
                        std::uint64_t memory_budget) {
  Document document({}, memory_budget);
  document.projects_[fs::weakly_canonical(project)] = content_hash(read_file(project));
  read_project(
      project,
      [&](const History::Entry& entry, const Scene& after) {
        add_sources(document.imported_, {entry.edit});
        document.history_.add(entry.edit, after, entry.joined, entry.replaced);
      },
      links, progress);
  return document;
}

namespace {

// The edits of a journal line; empty for undo and redo.
json edits_in(const json& entry) {
  if (entry.contains("adjust")) return entry.at("adjust").at("edits");
  if (entry.contains("edit")) return json::array({entry.at("edit")});
  return entry.contains("edits") ? entry.at("edits") : json::array();
}

// "line 7: bend", for the list of lost lines.
std::string named(std::size_t line, const json& entry) {
  std::string what;
  for (const json& edit : edits_in(entry)) what += (what.empty() ? "" : ", ") + edit.value("op", std::string("?"));
  if (what.empty()) what = entry.contains("undo") ? "undo" : "redo";
  return fmt::format("line {}: {}", line, what);
}

}  // namespace

namespace {

struct JournalLine {
  std::size_t number;  // line number in the file, from 1
  json entry;
};

bool reads_missing_source(const json& entry, const SourceLinks& links) {
  for (json edit : edits_in(entry))
    if (const json* const source = source_field(edit);
        source != nullptr && !source_problem(source->get<std::string>(), edit.value("content", ""), links).empty())
      return true;
  return false;
}

// The lines to replay: all of them, or only those of steps that are not undone (`skips_undone`) if only undone steps
// read a missing source. No other step depends on those.
std::vector<JournalLine> lines_to_replay(const Journal::Contents& contents, const SourceLinks& links,
                                         bool& skips_undone) {
  std::vector<JournalLine> lines;
  for (const std::string& text : contents.entries) lines.push_back({lines.size() + 2, json::parse(text)});
  const ActiveSteps done = steps_done(contents);
  std::vector<JournalLine> left;
  for (const std::size_t line : done.lines) left.push_back(lines[line]);
  const auto misses = [&](const std::vector<JournalLine>& some) {
    return std::any_of(some.begin(), some.end(),
                       [&](const JournalLine& line) { return reads_missing_source(line.entry, links); });
  };
  skips_undone = !done.partial && misses(lines) && !misses(left);
  return skips_undone ? left : lines;
}

}  // namespace

Document::Recovered Document::recover(const fs::path& path, const SourceLinks& links, const Progress& progress) {
  Journal::Contents contents;
  // Absolute, because the current folder may change while the journal is written.
  std::optional<Journal> journal = Journal::resume(absolute_path(path), contents);
  Recovered result;
  History& history = result.document.history_;
  result.torn = contents.torn;
  bool skips_undone = false;
  const std::vector<JournalLine> lines = lines_to_replay(contents, links, skips_undone);
  if (skips_undone) result.skipped_undone = steps_done(contents).undone;
  // Replays one line: all its edits or none.
  const auto replay = [&](const json& entry) {
    const bool adjusts = entry.contains("adjust");
    if (!adjusts && !entry.contains("edit") && !entry.contains("edits")) {
      if (!entry.contains("undo") && !entry.contains("redo")) throw Error("is not an edit, undo or redo");
      if (entry.contains("undo") ? !history.undo(count_in(entry.at("undo")), progress)
                                 : !history.redo(count_in(entry.at("redo")), progress))
        throw Error("there is nothing to undo or redo");
      return;
    }
    const json& step = adjusts ? entry.at("adjust") : entry;
    const std::size_t adjusted = adjusts && !skips_undone ? count_in(step.at("undo")) : 0;
    const std::size_t replaced = step.value("replaces", std::size_t{0});
    if (adjusted + replaced > history.undo_count()) throw Error("there is no step to adjust");
    const Scene start = history.scene_at(history.undo_count() - adjusted - replaced, progress);
    std::vector<std::pair<Edit, Scene>> made;
    for (json one : edits_in(entry)) {
      const Scene& before = made.empty() ? start : made.back().second;
      if (json* const source = source_field(one)) {
        const fs::path imported = source->get<std::string>();
        if (const std::string trouble = source_problem(imported, one.value("content", ""), links); !trouble.empty()) {
          result.gone.push_back({imported, one.value("content", ""), trouble});
          throw FileError(imported, trouble);
        }
        *source = resolved_source(imported, one.value("content", ""), links).string();
      }
      Edit edit = read_edit(one, before);
      Scene scene = rebake::apply(before, edit, progress).scene;
      made.emplace_back(std::move(edit), std::move(scene));
    }
    for (const auto& [edit, scene] : made) add_sources(result.document.imported_, {edit});
    history.forget_last(adjusted);
    for (std::size_t k = 0; k < made.size(); ++k)
      history.add(std::move(made[k].first), std::move(made[k].second), k > 0, k > 0 ? 0 : replaced);
  };
  std::vector<fs::path> imports;
  for (const std::string& text : contents.entries)
    for (json one : edits_in(json::parse(text)))
      if (const json* const source = source_field(one)) imports.emplace_back(source->get<std::string>());
  check_links(links, imports);
  std::size_t count = 0;
  for (const auto& [line, entry] : lines) {
    progress.at("recovering", static_cast<double>(++count) / static_cast<double>(lines.size() + 1));
    // Edits after a lost one would be applied to another scene than the user's.
    if (!result.lost.empty()) {
      result.lost.push_back(named(line, entry));
      continue;
    }
    try {
      replay(entry);
    } catch (const Cancelled&) {
      throw;
    } catch (const std::exception& error) {
      result.lost.push_back(fmt::format("{}: {}", named(line, entry), error.what()));
    }
  }
  result.header_damaged = contents.damaged_line == 1;
  if (contents.damaged_line > 1) result.lost.push_back(fmt::format("line {} is damaged", contents.damaged_line));
  for (const Journal::Contents::Line& after : contents.after)
    result.lost.push_back(named(after.number, json::parse(after.entry)) + " (behind the damage)");
  // The rest can still be recovered with the sources of its edits.
  if (!result.lost.empty() || skips_undone)
    for (const fs::path& source : imports)
      result.document.protect_input(source, "a source of an edit in the recovered journal");
  result.edits = history.undo_count();
  if (result.lost.empty() && links.empty() && !skips_undone && contents.damaged_line == 0 && contents.current)
    result.document.journal_ = std::move(journal);
  else
    result.journal = std::move(journal);
  return result;
}

std::vector<std::string> Document::Recovered::first_lost() const {
  constexpr std::size_t most = 20;
  std::vector<std::string> lines(lost.begin(), lost.begin() + static_cast<std::ptrdiff_t>(std::min(most, lost.size())));
  if (lost.size() > most) lines.push_back(fmt::format("and {} more", lost.size() - most));
  return lines;
}

SourceGuard Document::sources() const {
  SourceGuard guard = own_sources();
  guard.add_all(others_, "a source of another open document");
  return guard;
}

void Document::protect_sources_of_others(const std::vector<SourceGuard>& others) {
  others_ = {};
  for (const SourceGuard& other : others) others_.add_all(other, "a source of another open document");
}

SourceGuard Document::own_sources() const {
  SourceGuard guard = imported_;
  add_sources(guard, scene());
  if (journal_) guard.add_file(journal_->path(), "the journal of this document");
  return guard;
}

void Document::restore_protections(const SourceGuard& before) {
  imported_ = before;
  add_sources(imported_, history_.edits());
  add_sources(imported_, history_.undone());
}

void Document::protect_files_of(const json& edit) {
  if (edit.is_object() && edit.contains("mesh") && edit.at("mesh").is_string())
    protect_file(edit.at("mesh").get<std::string>(), "a cage mesh that this run reads");
}

void Document::keep_journal(const fs::path& path) {
  if (path.empty()) throw FieldError("path", "must not be empty: name the journal's file");
  if (!starts_empty_)
    throw Error("a journal needs a document that began empty: begin with an empty scene and import its contents");
  std::vector<json> entries;
  const std::vector<History::Entry> all = history_.entries();
  for (std::size_t first = 0; first < all.size();) {
    std::vector<Edit> step = {all[first].edit};
    const std::size_t replaced = all[first].replaced;
    for (++first; first < all.size() && all[first].joined; ++first) step.push_back(all[first].edit);
    entries.push_back(entry_of(step, replaced));
  }
  // Undone steps can be redone, so the journal contains them.
  if (history_.redo_count() > 0) entries.push_back({{"undo", history_.redo_count()}});
  sources().check_file(path);
  journal_ = Journal::create(absolute_path(path), entries);
}

void Document::edit(const Edit& edit, const Progress& progress) { edits({edit}, progress); }

namespace {

AppliedEdits done(const Scene& start, const std::vector<Edit>& edits, const Progress& progress,
                  const AppliedEdits* made) {
  return made != nullptr && made->matches_input(start, edits) ? *made : apply_edits(start, edits, progress);
}

}  // namespace

std::vector<Report> Document::add_to_history(AppliedEdits done, std::size_t replaced) {
  add_sources(imported_, done.edits);
  for (std::size_t k = 0; k < done.edits.size(); ++k)
    history_.add(std::move(done.edits[k]), std::move(done.scenes[k]), k > 0, k > 0 ? 0 : replaced);
  return std::move(done.reports);
}

std::vector<Report> Document::edits(const std::vector<Edit>& edits, const Progress& progress,
                                    const AppliedEdits* made) {
  if (edits.empty()) return {};
  AppliedEdits taken = done(scene(), edits, progress, made);
  if (journal_) {
    SourceGuard read;
    add_sources(read, taken.edits);
    if (!read.empty()) read.check_file(journal_->path());
    journal_->append(entry_of(taken.edits));
  }
  return add_to_history(std::move(taken));
}

std::vector<Report> Document::adjust(const std::vector<Edit>& edits, const Progress& progress,
                                     const AppliedEdits* made) {
  const std::size_t last = history_.undo_step();
  if (last == 0 || edits.empty()) throw EditError("there is no step to adjust, or no edit to replace it");
  const std::size_t replaced = history_.replaced_by_last_step();
  AppliedEdits taken =
      done(history_.scene_at(history_.undo_count() - last - replaced, progress), edits, progress, made);
  // One line: after a crash the step is there either as before or as after the adjustment.
  if (journal_) {
    json entry = {{"undo", last}, {"edits", json::array()}};
    for (const Edit& edit : taken.edits) entry["edits"].push_back(to_json(edit));
    if (replaced > 0) entry["replaces"] = replaced;
    journal_->append({{"adjust", entry}});
  }
  history_.forget_last(last);
  return add_to_history(std::move(taken), replaced);
}

std::vector<Report> Document::revise(const std::vector<Edit>& edits, const Progress& progress,
                                     const AppliedEdits* made) {
  const std::size_t last = history_.undo_step();
  if (last == 0 || edits.empty()) throw EditError("there is no step to revise, or no edit to replace it");
  const std::size_t replaced = last + history_.replaced_by_last_step();
  AppliedEdits taken = done(history_.scene_at(history_.undo_count() - replaced, progress), edits, progress, made);
  if (journal_) journal_->append(entry_of(taken.edits, replaced));
  return add_to_history(std::move(taken), replaced);
}

bool Document::undo(std::size_t edits, const Progress& progress) {
  if (!history_.undo(edits, progress)) return false;
  try {
    if (journal_) journal_->append({{"undo", edits}});
  } catch (...) {
    history_.redo(edits);
    throw;
  }
  return true;
}

bool Document::redo(std::size_t edits, const Progress& progress) {
  if (!history_.redo(edits, progress)) return false;
  try {
    if (journal_) journal_->append({{"redo", edits}});
  } catch (...) {
    history_.undo(edits);
    throw;
  }
  return true;
}

bool Document::undo_step(const Progress& progress) {
  return history_.undo_count() > 0 && undo(history_.undo_step(), progress);
}
bool Document::redo_step(const Progress& progress) {
  return history_.redo_count() > 0 && redo(history_.redo_step(), progress);
}

void Document::check_project(const fs::path& project, OtherProject other) const {
  Journal::refuse_overwriting(project);
  refuse_replacing_foreign(project);
  if (other == OtherProject::replace || !fs::exists(project)) return;
  const auto known = projects_.find(fs::weakly_canonical(project));
  if (known == projects_.end()) {
    if (other == OtherProject::keep) throw FileError(project, "already exists; choose another name, or use --replace");
    refuse_replacing_more(project, history_.undo_count());
  } else if (known->second != content_hash(read_file(project))) {
    throw FileError(
        project,
        "was changed by another program after it was opened or saved here; save under another name, or open "
        "it again");
  }
}

SavedProject Document::save(const fs::path& project, const Progress& progress, OtherProject other) {
  if (!starts_empty_)
    throw Error("the document did not begin empty, so it cannot be saved as a project: import its contents instead");
  std::vector<History::Entry> entries = history_.entries();
  entries.erase(entries.begin() + static_cast<std::ptrdiff_t>(history_.undo_count()), entries.end());
  // Two programs that save to one project do so one after the other, so that the second sees what the first wrote.
  const FolderLock lock(fs::weakly_canonical(project).parent_path());
  check_project(project, other);
  const bool is_known = projects_.contains(fs::weakly_canonical(project));
  const std::vector<std::string> before =
      is_known || other != OtherProject::keep_more ? std::vector<std::string>() : edits_in(project);
  SavedProject saved = write_project(project, entries, sources(), progress);
  projects_[fs::weakly_canonical(project)] = content_hash(read_file(project));
  const std::vector<std::string> after = before.empty() ? before : edits_in(project);
  if (const auto differs = std::mismatch(before.begin(), before.end(), after.begin(), after.end()).first;
      differs != before.end())
    saved.warnings.push_back("it replaced a project with " +
                             counted(static_cast<std::size_t>(before.end() - differs), "other edit"));
  return saved;
}

void Document::discard_journal() {
  if (!journal_) return;
  journal_->discard();
  journal_.reset();
}

}  // namespace rebake
