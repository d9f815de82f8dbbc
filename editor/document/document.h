#pragma once

#include <memory>
#include <optional>

#include "editor/document/carried_out.h"
#include "editor/document/history.h"
#include "editor/document/journal.h"
#include "editor/document/sources.h"

namespace rebake {

/// What people work on: a scene with its history, on disk as a project, and kept safe by a journal. A thrown edit
/// leaves everything as it was. What can take long takes a Progress, and throws Cancelled when it says so.
class Document {
 public:
  explicit Document(Scene start = {}, std::uint64_t memory_budget = History::default_budget);

  /// Opens a project. Throws FileError, SourcesGone.
  static Document open(const std::filesystem::path& project, const Relinked& links = {}, const Progress& progress = {},
                       std::uint64_t memory_budget = History::default_budget);
  /// Gets the work of a journal back, as far as it can be: what stands behind damage, or wants a source that is gone,
  /// is listed. Undone steps that want such a source are left out. Where all is there and nothing was relinked, it goes
  /// on writing the journal. Throws FileError for a
  /// file that is no journal.
  struct Recovered;
  static Recovered recover(const std::filesystem::path& journal, const Relinked& links = {},
                           const Progress& progress = {});

  const Scene& scene() const { return history_.now(); }
  const History& history() const { return history_; }
  /// Everything that was ever imported, undone or not, where the present objects came from, and what is protected.
  SourceGuard sources() const;
  /// Nothing may be written over this folder or file either, as SourceGuard::add_input takes it.
  void protect_input(const std::filesystem::path& source, const std::string& role) {
    imported_.add_input(source, role);
  }
  /// As SourceGuard::add_contents takes it.
  void protect_contents(const std::filesystem::path& folder, const std::string& role) {
    imported_.add_contents(folder, role);
  }
  void release_contents(const std::filesystem::path& folder) { imported_.release_contents(folder); }
  /// Nothing may be written over this file either. `role` as SourceGuard::add_file takes it.
  void protect_file(const std::filesystem::path& file, const std::string& role) { imported_.add_file(file, role); }
  /// Protects the files that reading an edit's JSON reads: the mesh of a cage.
  void protect_files_of(const nlohmann::json& edit);

  /// From here on every edit is in a journal and on the disk before edit() returns. What was done before is written
  /// first. Throws FileError when there is a journal at that path already, and Error for a document that did not start
  /// from an empty scene: its start could not be got back.
  void keep_journal(const std::filesystem::path& path);
  bool keeps_journal() const { return journal_.has_value(); }
  /// Empty without a journal.
  std::filesystem::path journal_path() const { return journal_ ? journal_->path() : std::filesystem::path(); }

  void edit(const Edit& edit, const Progress& progress = {});
  /// All of them, to be undone together, or none where one throws. What each did. Where `made` is of the present scene
  /// and these edits, that is taken, and nothing is done twice.
  std::vector<Report> edits(const std::vector<Edit>& edits, const Progress& progress = {},
                            const CarriedOut* made = nullptr);
  /// In place of the last step, or nothing where one throws: that step stays then; `made` is of the scene before it.
  /// Throws EditError without one.
  std::vector<Report> adjust(const std::vector<Edit>& edits, const Progress& progress = {},
                             const CarriedOut* made = nullptr);
  /// As adjust(), but as a new step: undo returns to the step that it replaces. For tools that refine one edit in many
  /// steps, like the releases of a cage. edits() of the history then holds the refined edit only.
  std::vector<Report> revise(const std::vector<Edit>& edits, const Progress& progress = {},
                             const CarriedOut* made = nullptr);
  /// So many edits back or forth, or none; false where there are fewer.
  bool undo(std::size_t edits = 1, const Progress& progress = {});
  bool redo(std::size_t edits = 1, const Progress& progress = {});
  /// All that was made together with the last edit, or with the next one; false where there is none.
  bool undo_step(const Progress& progress = {});
  bool redo_step(const Progress& progress = {});

  /// Writes the project. Returns warnings: sources that are not as they were, without which it cannot be opened. Throws
  /// FileError.
  std::vector<std::string> save(const std::filesystem::path& project, const Progress& progress = {}) const;
  /// Removes the journal: the work is not wanted, or safe elsewhere.
  void discard_journal();

 private:
  std::vector<Report> take_in(CarriedOut done, std::size_t replaced = 0);

  bool starts_empty_;
  History history_;
  SourceGuard imported_;  ///< also by edits that history has dropped: a journal reads them again
  std::optional<Journal> journal_;
};

struct Document::Recovered {
  Document document;
  std::size_t edits = 0;          ///< that were got back, undone ones not counted
  bool nameless = false;          ///< its first line, which holds the version, is damaged; no edit is lost by it
  bool torn = false;              ///< an edit was being written when the program ended: it is lost
  std::vector<std::string> lost;  ///< what could not be got back, a sentence each
  std::vector<SourcesGone::Source> gone;  ///< sources that it wants, and that are not as they were
  /// The first of `lost`, and how many more there are.
  std::vector<std::string> first_lost() const;
  std::optional<Journal> journal;  ///< the file itself, where the document does not go on writing it
};

}  // namespace rebake
