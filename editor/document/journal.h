#pragma once

#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace rebake {

/// A file of what was done, a checksummed line each, for getting work back after a crash. A line is on the disk before
/// append() returns.
///
///     <16 hexadecimal digits: XXH64 of the rest of the line> {"rebake_journal": 3}
///     <digits> {"n": 1, "edit": {"op": "import", …}}
///     <digits> {"n": 2, "edits": [{"op": "hide", …}, {"op": "hide", …}]}     made together
///     <digits> {"n": 3, "undo": 2}     so many edits; true: one
///     <digits> {"n": 4, "edit": {"op": "cage", …}, "replaces": 1}     made of the scene before the last edit
///
/// Version 1 had no lines of several edits, version 2 no "replaces"; both are still read.
class Journal {
 public:
  /// Begins a journal with these lines, all on the disk before this returns. Throws FileError when there is a file
  /// already (it may hold work) or it cannot be written.
  static Journal create(const std::filesystem::path& path, const std::vector<nlohmann::json>& entries);
  /// Opens a journal to go on where it ends: what is torn behind the last whole line is cut off. One that is damaged is
  /// left as it is, and takes no more entries. No other process can write it meanwhile. Throws FileError as read()
  /// does.
  struct Contents;
  static Journal resume(const std::filesystem::path& path, Contents& contents);

  ~Journal();
  Journal(Journal&&) noexcept;
  Journal& operator=(Journal&&) noexcept;

  /// Appends one entry and waits until it is on the disk. Throws FileError, also when another file has taken its path;
  /// the journal then ends before the entry.
  void append(const nlohmann::json& entry);
  const std::filesystem::path& path() const;
  /// Removes the file: the work is safe elsewhere. Leaves a file that has taken its path. Throws FileError.
  void discard();

  /// What a journal holds, in order.
  struct Contents {
    bool current = true;               ///< written in this version's format: older programs refuse lines added to it
    std::vector<std::string> entries;  ///< as JSON: all that are whole, before the first that is not
    bool torn = false;                 ///< something followed that was being written when the program ended
    std::size_t damaged_line = 0;      ///< the first that is not what was written, from 1; 0 for none
    struct Line {
      std::size_t number;
      std::string entry;  ///< as JSON
    };
    std::vector<Line> after;  ///< whole lines behind the damage
  };
  /// Whether the file begins as a journal does, whole or damaged.
  static bool is_journal(const std::filesystem::path& path);
  /// Whether another process is writing it now.
  static bool in_use(const std::filesystem::path& path);
  /// Throws FileError for a file that is no journal or is from a newer version.
  static Contents read(const std::filesystem::path& path);

 private:
  class File;
  explicit Journal(std::unique_ptr<File> file);
  std::unique_ptr<File> file_;
};

/// Steps of history that a journal's whole lines leave done. Edits of one line are one step.
struct StepsDone {
  std::vector<std::size_t> lines;  ///< of each step, as an index into Contents::entries
  bool partly = false;             ///< after them some edits of one more step are done
};
StepsDone steps_done(const Journal::Contents& contents);

}  // namespace rebake
