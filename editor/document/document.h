#pragma once

#include <map>
#include <memory>
#include <optional>

#include "editor/document/applied_edits.h"
#include "editor/document/history.h"
#include "editor/document/journal.h"
#include "editor/document/project.h"
#include "editor/document/sources.h"
#include "mesh_ops/formats/scene_files.h"

namespace rebake {

/// A scene with its history; saved as a project, and protected against crashes by a journal. An edit that throws
/// changes nothing. Long operations take a Progress and throw Cancelled on cancellation.
class Document {
 public:
  /// `memory_budget`: bytes, see History.
  explicit Document(Scene start = {}, std::uint64_t memory_budget = History::default_budget);

  /// Opens a project by replaying its edits. Throws FileError, and SourcesUnavailable for missing or changed sources.
  static Document open(const std::filesystem::path& project, const SourceLinks& links = {},
                       const Progress& progress = {}, std::uint64_t memory_budget = History::default_budget);
  /// Replays a journal as far as possible. Lines behind damage and edits with a missing source are listed as lost;
  /// undone steps with a missing source are skipped. The document continues to write the journal if it is complete,
  /// undamaged, of the current version, and nothing was relinked or skipped. Throws FileError for a file that is no
  /// journal.
  struct Recovered;
  static Recovered recover(const std::filesystem::path& journal, const SourceLinks& links = {},
                           const Progress& progress = {});

  const Scene& scene() const { return history_.now(); }
  const History& history() const { return history_; }
  /// Files that no output may overwrite: all imports (undone ones too), the origins of the scene's objects, the
  /// journal, and the inputs that were added below.
  SourceGuard sources() const;
  /// As sources(), without those of other documents.
  SourceGuard own_sources() const;
  /// Protects the own_sources() of other documents of this process; replaces earlier ones.
  void protect_sources_of_others(const std::vector<SourceGuard>& others);
  /// Protects a folder or file from being overwritten: protect_input() (scene_files.h).
  void protect_input(const std::filesystem::path& source, const std::string& role) {
    ::rebake::protect_input(imported_, source, role);
  }
  /// Protects all sources of a guard.
  void protect_all(const SourceGuard& guard) { imported_.add_all(guard, "a file that this run reads"); }
  /// Protects the files in a scene folder: protect_scene_contents().
  void protect_contents(const std::filesystem::path& folder, const std::string& role) {
    protect_scene_contents(imported_, folder, role);
  }
  /// Ends protect_contents(), after the folder was replaced.
  void release_contents(const std::filesystem::path& folder) { imported_.release_contents(folder); }
  /// Protects a file from being overwritten: SourceGuard::add_file().
  void protect_file(const std::filesystem::path& file, const std::string& role) { imported_.add_file(file, role); }
  /// The present protections, and their restoration: of those added since, only sources of edits stay protected.
  const SourceGuard& protections() const { return imported_; }
  void restore_protections(const SourceGuard& before);
  /// Protects the file that is read while an edit's JSON is parsed: the mesh of a cage.
  void protect_files_of(const nlohmann::json& edit);

  /// Begins a journal with all steps so far; from now on each edit is on the disk before edit() returns. Throws
  /// FileError if the file exists, and Error for a document that did not start with an empty scene, which a journal
  /// cannot restore.
  void keep_journal(const std::filesystem::path& path);
  bool keeps_journal() const { return journal_.has_value(); }
  /// Whether a journal or a project of this document needs its sources.
  bool has_saved_work() const { return keeps_journal() || !projects_.empty(); }
  /// Path of the journal; empty without one.
  std::filesystem::path journal_path() const { return journal_ ? journal_->path() : std::filesystem::path(); }

  /// Applies one edit as a step of history. Throws EditError, FieldError, FileError.
  void edit(const Edit& edit, const Progress& progress = {});
  /// Applies edits as one step of history; none if one throws. Returns a report per edit. `made` is used as the result
  /// if it was computed for these edits and the present scene.
  std::vector<Report> edits(const std::vector<Edit>& edits, const Progress& progress = {},
                            const AppliedEdits* made = nullptr);
  /// Replaces the last step by these edits, applied to the scene before it; undo does not return to the old step. The
  /// old step stays if an edit throws. `made` must start from the scene before the step. Throws EditError if there is
  /// no step or no edit.
  std::vector<Report> adjust(const std::vector<Edit>& edits, const Progress& progress = {},
                             const AppliedEdits* made = nullptr);
  /// As adjust(), but undo returns to the replaced step. For tools that refine one edit in many steps, such as the
  /// drags of a cage. History::edits() then contains only the refined edit.
  std::vector<Report> revise(const std::vector<Edit>& edits, const Progress& progress = {},
                             const AppliedEdits* made = nullptr);
  /// Undoes or redoes this many edits; returns false and does nothing if there are fewer.
  bool undo(std::size_t edits = 1, const Progress& progress = {});
  bool redo(std::size_t edits = 1, const Progress& progress = {});
  /// Undoes the last step or redoes the next one, with all its edits; false if there is none.
  bool undo_step(const Progress& progress = {});
  bool redo_step(const Progress& progress = {});

  /// Treatment of a project at the path of save() that this document neither opened nor saved.
  enum class OtherProject {
    keep_more,  ///< throw FileError if it has more edits than this document, else replace it with a warning
    keep,       ///< throw FileError
    replace     ///< replace it; for people who have confirmed it
  };
  /// Writes the project. Warns of missing and changed sources, and of replaced edits. Throws FileError, also if the
  /// file was changed after this document opened or saved it (unless `other` is replace), and if it exists and is no
  /// project.
  SavedProject save(const std::filesystem::path& project, const Progress& progress = {},
                    OtherProject other = OtherProject::keep_more);
  /// Ends and removes the journal, after the work was saved or given up.
  void discard_journal();

 private:
  std::vector<Report> add_to_history(AppliedEdits done, std::size_t replaced = 0);

  /// Refuses to replace a project that may hold other work; see save().
  void check_project(const std::filesystem::path& project, OtherProject other) const;

  bool starts_empty_;  ///< the history began with an empty scene, so that edits alone restore it
  History history_;
  SourceGuard imported_;  ///< also of edits that history has forgotten: a journal replays them
  SourceGuard others_;    ///< sources of other documents
  std::optional<Journal> journal_;
  /// Projects that were opened or saved: canonical path → hash of the contents.
  std::map<std::filesystem::path, std::uint64_t> projects_;
};

/// Result of Document::recover().
struct Document::Recovered {
  Document document;
  std::size_t edits = 0;                         ///< number of recovered edits, without undone ones
  bool header_damaged = false;                   ///< the first line (format version) is damaged; it contains no edit
  std::size_t skipped_undone = 0;                ///< undone edits left out, because a source of theirs is missing
  bool torn = false;                             ///< the program ended while it wrote a last edit, which is lost
  std::vector<std::string> lost;                 ///< one line of text per lost journal line, with the reason
  std::vector<SourcesUnavailable::Source> gone;  ///< missing or changed sources of lost edits
  /// The first 20 of `lost`, and the number of the others.
  std::vector<std::string> first_lost() const;
  /// The file, if the document does not continue to write it; empty if it may not be written, as on read-only media.
  std::optional<Journal> journal;
};

}  // namespace rebake
