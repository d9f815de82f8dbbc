#include "editor/document/document.h"

#include <fmt/format.h>

#include "editor/document/project.h"
#include "mesh_ops/formats/files.h"

namespace rebake {

using nlohmann::json;
namespace fs = std::filesystem;

namespace {

// One line for what was made together: a torn journal holds all of it or nothing.
json entry_of(const std::vector<Edit>& edits) {
  if (edits.size() == 1) return {{"edit", to_json(edits.front())}};
  json entry = {{"edits", json::array()}};
  for (const Edit& edit : edits) entry["edits"].push_back(to_json(edit));
  return entry;
}

// Journals of earlier versions say true for one.
std::size_t count_in(const json& value) { return value.is_boolean() ? 1 : value.get<std::size_t>(); }

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
      if (entry.contains("edit") || entry.contains("edits")) {
        bool joined = false;
        for (const json& one : entry.contains("edit") ? json::array({entry.at("edit")}) : entry.at("edits")) {
          Edit edit = read_edit(one, result.document.scene());
          Scene scene = rebake::apply(result.document.scene(), edit);
          result.document.history_.add(std::move(edit), std::move(scene), joined);
          joined = true;
        }
      } else if (!entry.contains("undo") && !entry.contains("redo")) {
        throw Error("is neither an edit nor undo or redo");
      } else if (entry.contains("undo") ? !result.document.history_.undo(count_in(entry.at("undo")))
                                        : !result.document.history_.redo(count_in(entry.at("redo")))) {
        throw Error("there is nothing to undo or redo");
      }
    } catch (const json::exception& error) {
      throw FileError(path, fmt::format("line {}: {}", number, error.what()));
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
  for (std::size_t first = 0; first < edits.size();) {
    std::size_t end = first + 1;
    while (end < edits.size() && joined[end]) ++end;
    entries.push_back(entry_of(
        {edits.begin() + static_cast<std::ptrdiff_t>(first), edits.begin() + static_cast<std::ptrdiff_t>(end)}));
    first = end;
  }
  journal_ = Journal::create(fs::absolute(path).lexically_normal(), json::object(), std::move(entries));
}

void Document::edit(const Edit& edit, const Progress& progress) { edits({edit}, progress); }

std::vector<Scene> Document::edits(const std::vector<Edit>& edits, const Progress& progress) {
  std::vector<Scene> scenes;
  std::vector<Edit> whole;
  for (const Edit& edit : edits) {
    whole.push_back(completed(edit));
    scenes.push_back(rebake::apply(scenes.empty() ? scene() : scenes.back(), whole.back(), progress));
  }
  if (whole.empty()) return scenes;
  if (journal_) journal_->append(entry_of(whole));
  for (std::size_t k = 0; k < whole.size(); ++k) history_.add(std::move(whole[k]), scenes[k], k > 0);
  return scenes;
}

bool Document::undo(std::size_t edits) {
  if (!history_.undo(edits)) return false;
  try {
    if (journal_) journal_->append({{"undo", edits}});
  } catch (...) {
    history_.redo(edits);
    throw;
  }
  return true;
}

bool Document::redo(std::size_t edits) {
  if (!history_.redo(edits)) return false;
  try {
    if (journal_) journal_->append({{"redo", edits}});
  } catch (...) {
    history_.undo(edits);
    throw;
  }
  return true;
}

bool Document::undo_step() { return history_.undo_count() > 0 && undo(history_.undo_step()); }
bool Document::redo_step() { return history_.redo_count() > 0 && redo(history_.redo_step()); }

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
