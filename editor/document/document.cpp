#include "editor/document/document.h"

#include <fmt/format.h>

#include "editor/document/project.h"
#include "mesh_ops/formats/files.h"

namespace rebake {

using nlohmann::json;
namespace fs = std::filesystem;

Document::Document(Scene start, std::uint64_t memory_budget)
    : starts_empty_(start.roots.empty()), history_(std::move(start), memory_budget) {}

Document Document::open(const fs::path& project, std::uint64_t memory_budget) {
  Document document({}, memory_budget);
  ReadProject read = read_project(project);
  for (std::size_t k = 0; k < read.edits.size(); ++k)
    document.history_.add(std::move(read.edits[k]), std::move(read.scenes[k]));
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
        result.document.history_.add(std::move(edit), std::move(scene));
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
  for (const Edit& edit : history_.edits()) entries.push_back({{"edit", to_json(edit)}});
  journal_ = Journal::create(fs::absolute(path).lexically_normal(), json::object(), std::move(entries));
}

void Document::edit(const Edit& edit, const Progress& progress) {
  const Edit whole = completed(edit);
  Scene after = rebake::apply(scene(), whole, progress);
  if (journal_) journal_->append({{"edit", to_json(whole)}});
  history_.add(whole, std::move(after));
}

bool Document::undo() {
  if (!history_.undo()) return false;
  try {
    if (journal_) journal_->append({{"undo", true}});
  } catch (...) {
    history_.redo();
    throw;
  }
  return true;
}

bool Document::redo() {
  if (!history_.redo()) return false;
  try {
    if (journal_) journal_->append({{"redo", true}});
  } catch (...) {
    history_.undo();
    throw;
  }
  return true;
}

void Document::save(const fs::path& project) const {
  if (!starts_empty_) throw Error("only what was imported by edits can be saved as a project");
  write_project(project, history_.edits());
}

void Document::discard_journal() {
  if (!journal_) return;
  journal_->discard();
  journal_.reset();
}

}  // namespace rebake
