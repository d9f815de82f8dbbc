#include "editor/document/document.h"

#include <fmt/format.h>

#include "editor/document/project.h"
#include "mesh_ops/formats/files.h"

namespace rebake {

using nlohmann::json;
namespace fs = std::filesystem;

namespace {

json entry_of(const Edit& edit, bool joined) {
  json entry = {{"edit", to_json(edit)}};
  if (joined) entry["joined"] = true;
  return entry;
}

}  // namespace

Document::Document(Scene start, std::uint64_t memory_budget)
    : starts_empty_(start.roots.empty()), history_(std::move(start), memory_budget) {}

Document Document::open(const fs::path& project, std::uint64_t memory_budget) {
  Document document({}, memory_budget);
  ReadProject read = read_project(project);
  for (std::size_t k = 0; k < read.edits.size(); ++k)
    document.history_.add(std::move(read.edits[k]), std::move(read.scenes[k]), read.joined[k]);
  return document;
}

Document::Recovered Document::recover(const fs::path& path) {
  Journal::Contents contents;
  Journal journal = Journal::resume(path, contents);
  Recovered result;
  result.torn = contents.torn;
  std::size_t number = 1;
  for (const json& entry : contents.entries) {
    ++number;
    try {
      if (entry.contains("edit")) {
        Edit edit = read_edit(entry.at("edit"), result.document.scene());
        Scene scene = rebake::apply(result.document.scene(), edit);
        result.document.history_.add(std::move(edit), std::move(scene), entry.value("joined", false));
      } else if (!entry.contains("undo") && !entry.contains("redo")) {
        throw Error("is neither an edit nor undo or redo");
      } else if (entry.contains("undo") ? !result.document.history_.undo() : !result.document.history_.redo()) {
        throw Error("there is nothing to undo or redo");
      }
    } catch (const Error& error) {
      throw FileError(path, fmt::format("line {}: {}", number, error.what()));
    }
  }
  result.edits = result.document.history_.undo_count();
  result.document.journal_ = std::move(journal);
  return result;
}

void Document::keep_journal(const fs::path& path) {
  if (!starts_empty_) throw Error("a journal can be kept only from an empty scene on: import what is in it");
  std::vector<json> entries;
  const std::vector<Edit> edits = history_.edits();
  const std::vector<bool> joined = history_.joined();
  for (std::size_t k = 0; k < edits.size(); ++k) entries.push_back(entry_of(edits[k], joined[k]));
  journal_ = Journal::create(fs::absolute(path).lexically_normal(), json::object(), std::move(entries));
}

void Document::edit(const Edit& edit, const Progress& progress) { edits({edit}, progress); }

std::vector<Scene> Document::edits(const std::vector<Edit>& edits, const Progress& progress) {
  std::vector<Scene> scenes;
  std::vector<Edit> whole;
  std::vector<json> entries;
  for (const Edit& edit : edits) {
    whole.push_back(completed(edit));
    scenes.push_back(rebake::apply(scenes.empty() ? scene() : scenes.back(), whole.back(), progress));
    entries.push_back(entry_of(whole.back(), !entries.empty()));
  }
  if (journal_) journal_->append(std::move(entries));
  for (std::size_t k = 0; k < whole.size(); ++k) history_.add(std::move(whole[k]), scenes[k], k > 0);
  return scenes;
}

bool Document::undo() {
  if (!history_.undo()) return false;
  try {
    if (journal_) journal_->append({json{{"undo", true}}});
  } catch (...) {
    history_.redo();
    throw;
  }
  return true;
}

bool Document::redo() {
  if (!history_.redo()) return false;
  try {
    if (journal_) journal_->append({json{{"redo", true}}});
  } catch (...) {
    history_.undo();
    throw;
  }
  return true;
}

bool Document::undo_step() {
  for (bool joined = true; joined;) {
    joined = history_.undo_count() > 0 && history_.joined()[history_.undo_count() - 1];
    if (!undo()) return false;
  }
  return true;
}

bool Document::redo_step() {
  if (!redo()) return false;
  while (history_.redo_count() > 0 && history_.joined()[history_.undo_count()]) redo();
  return true;
}

void Document::save(const fs::path& project) const {
  if (!starts_empty_) throw Error("only what was imported by edits can be saved as a project");
  write_project(project, history_.edits(), history_.joined());
}

void Document::discard_journal() {
  if (!journal_) return;
  journal_->discard();
  journal_.reset();
}

}  // namespace rebake
