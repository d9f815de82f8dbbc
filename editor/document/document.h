#pragma once

#include <memory>
#include <optional>

#include "editor/document/history.h"
#include "editor/document/journal.h"

namespace rebake {

/// What people work on: a scene with its history, on disk as a project, and kept safe by a journal. A thrown edit
/// leaves everything as it was.
class Document {
 public:
  explicit Document(Scene start = {}, std::uint64_t memory_budget = History::default_budget);

  /// Opens a project. Throws FileError.
  static Document open(const std::filesystem::path& project, std::uint64_t memory_budget = History::default_budget);
  /// Gets the work of a journal back, and goes on writing it. Throws FileError.
  struct Recovered;
  static Recovered recover(const std::filesystem::path& journal);

  const Scene& scene() const { return history_.now(); }
  const History& history() const { return history_; }

  /// From here on every edit is in a journal and on the disk before edit() returns. What was done before is written
  /// first. Throws FileError when there is a journal at that path already, and Error for a document that did not start
  /// from an empty scene: its start could not be got back.
  void keep_journal(const std::filesystem::path& path);

  void edit(const Edit& edit, const Progress& progress = {});
  /// All of them, to be undone together, or none where one throws. The scene after each.
  std::vector<Scene> edits(const std::vector<Edit>& edits, const Progress& progress = {});
  /// So many edits back or forth, or none; false where there are fewer.
  bool undo(std::size_t edits = 1);
  bool redo(std::size_t edits = 1);
  /// All that was made together with the last edit, or with the next one; false where there is none.
  bool undo_step();
  bool redo_step();

  /// Writes the project. Throws FileError.
  void save(const std::filesystem::path& project) const;
  /// Removes the journal: the work is not wanted, or safe elsewhere.
  void discard_journal();

 private:
  bool starts_empty_;
  History history_;
  std::optional<Journal> journal_;
};

struct Document::Recovered {
  Document document;
  std::size_t edits = 0;  ///< that the journal held, undone ones not counted
  bool torn = false;      ///< an edit was being written when the program ended: it is lost
};

}  // namespace rebake
