#pragma once

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace rebake {

/// A file of what was done, a checksummed line each, for getting work back after a crash. A line is on the disk before
/// append() returns.
///
///     <16 hexadecimal digits: XXH64 of the rest of the line> {"rebake_journal": 1, …}
///     <digits> {"n": 1, "edit": {"op": "import", …}}
///     <digits> {"n": 2, "edits": [{"op": "hide", …}, {"op": "hide", …}]}     made together
///     <digits> {"n": 3, "undo": 2}     so many edits; true: one
class Journal {
 public:
  /// Begins a journal. Throws FileError when there is a file already (it may hold work) or it cannot be written.
  /// `about` is kept in the first line; `entries` come behind it, all on the disk before this returns.
  static Journal create(const std::filesystem::path& path, nlohmann::json about,
                        std::vector<nlohmann::json> entries = {});
  /// Opens a journal to go on where it ends: what is torn behind the last whole line is cut off. No other process can
  /// write it meanwhile. Throws FileError as read() does; the file is left as it was then.
  struct Contents;
  static Journal resume(const std::filesystem::path& path, Contents& contents);

  ~Journal();
  Journal(Journal&&) noexcept;
  Journal& operator=(Journal&&) noexcept;

  /// Appends one entry and waits until it is on the disk. Throws FileError; the journal then ends before the entry.
  void append(nlohmann::json entry);
  const std::filesystem::path& path() const;
  /// Removes the file: the work is safe elsewhere.
  void discard();

  /// What a journal holds, in order.
  struct Contents {
    nlohmann::json about;
    std::vector<nlohmann::json> entries;
    bool torn = false;  ///< something followed that was being written when the program ended
  };
  /// Whether another process is writing it now.
  static bool in_use(const std::filesystem::path& path);
  /// Throws FileError for a file that is no journal, is from a newer version, or is damaged before its last line.
  static Contents read(const std::filesystem::path& path);

 private:
  class File;
  explicit Journal(std::unique_ptr<File> file);
  std::unique_ptr<File> file_;
};

}  // namespace rebake
