#pragma once

#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace rebake {

/// Write-ahead log of a document for recovery after a crash: one checksummed line per step, undo or redo. A line is on
/// the disk before append() returns. Only one process can write a journal.
///
///     <16 hexadecimal digits: XXH64 of the rest of the line> {"rebake_journal": 3}
///     <digits> {"n": 1, "edit": {"op": "import", …}}
///     <digits> {"n": 2, "edits": [{"op": "hide", …}, {"op": "hide", …}]}     one step of several edits
///     <digits> {"n": 3, "undo": 2}     undoes 2 edits; `true` means 1
///     <digits> {"n": 4, "edit": {"op": "cage", …}, "replaces": 1}     applied to the scene before the last edit
///     <digits> {"n": 5, "adjust": {"undo": 1, "edits": [{…}]}}     replaces the last edit; undo cannot return to it
///
/// Version 1 had no lines with several edits, version 2 no "replaces"; both are still read.
class Journal {
 public:
  struct Contents;

  /// Creates a journal with these entries, all on the disk on return. Throws FileError if the file exists (it may
  /// contain unsaved work) or cannot be written.
  static Journal create(const std::filesystem::path& path, const std::vector<nlohmann::json>& entries);
  /// Opens a journal for appending; the first append removes a torn last line. A damaged journal is left unchanged and
  /// refuses further entries. Locks the file. Returns nothing, but reads the contents, if the file may not be written,
  /// as on read-only media. Throws FileError as read() does, and if another process has locked it.
  static std::optional<Journal> resume(const std::filesystem::path& path, Contents& contents);

  ~Journal();
  Journal(Journal&&) noexcept;
  Journal& operator=(Journal&&) noexcept;

  /// Appends one entry and syncs it. Throws FileError if that fails or if the path leads to another file by now; the
  /// journal then ends before the entry.
  void append(const nlohmann::json& entry);
  const std::filesystem::path& path() const;
  /// Removes the file, after the work was saved elsewhere; does nothing if the path leads to another file by now.
  /// Throws FileError.
  void discard();

  /// Parsed lines of a journal.
  struct Contents {
    bool current = true;               ///< has the current format version; only then may lines be added
    std::vector<std::string> entries;  ///< JSON of the intact lines before any damage, without line 1
    bool torn = false;                 ///< the last line is incomplete: the program ended while writing
    std::size_t damaged_line = 0;      ///< number of the first damaged line, from 1; 0: none
    struct Line {
      std::size_t number;  ///< line number in the file, from 1
      std::string entry;   ///< its JSON
    };
    std::vector<Line> after;  ///< intact lines after the damage
  };
  /// Whether the file's first line is that of a journal, even with a wrong checksum.
  static bool is_journal(const std::filesystem::path& path);
  /// Throws FileError if the file at `path` is a journal, which an output would overwrite.
  static void refuse_overwriting(const std::filesystem::path& path);
  /// Whether a process has locked it for writing.
  static bool in_use(const std::filesystem::path& path);
  /// Parses a journal. Throws FileError for a file that is no journal or has a newer version.
  static Contents read(const std::filesystem::path& path);

 private:
  class File;
  explicit Journal(std::unique_ptr<File> file);
  std::unique_ptr<File> file_;
};

/// Steps in effect (not undone) after all intact lines of a journal. The edits of one line are one step.
struct ActiveSteps {
  std::vector<std::size_t> lines;  ///< index into Contents::entries of each step
  bool partial = false;            ///< an undo or redo ended inside a step of several edits
  std::size_t undone = 0;          ///< edits that could be redone
};
ActiveSteps steps_done(const Journal::Contents& contents);

}  // namespace rebake
