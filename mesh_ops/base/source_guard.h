#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace rebake {

/// Folders and files that no output may overwrite, because this run reads them and undo, journals and projects read
/// them again. Paths are compared by what they lead to (device and inode, so that links, hard links, bind mounts and
/// file systems that ignore case are seen through) and by name for what does not exist yet.
class SourceGuard {
 public:
  SourceGuard() = default;

  /// Protects a folder with everything in it, or the folder of a file such as scene.json, and every file elsewhere that
  /// links in it lead to. A folder that does not exist is protected by its name.
  void add(const std::filesystem::path& source);
  /// Protects a file, not its neighbours. `role` completes "is …, which …" in the error: "the script of this run".
  void add_file(const std::filesystem::path& source, const std::string& role = "a file that this run reads");
  /// Protects a file as add_file() does, unless it is a scene.json; anything else as add() does.
  void add_input(const std::filesystem::path& source, const std::string& role = "a file that this run reads");
  /// Protects what is in a scene folder, which may be replaced as a whole: a script may import its own export, and may
  /// run again.
  void add_contents(const std::filesystem::path& folder, const std::string& role);
  /// Ends what add_contents() protects: the run has replaced the folder.
  void release_contents(const std::filesystem::path& folder);
  bool empty() const { return sources_.empty(); }

  /// Throws FileError when writing a file at `path` would overwrite a protected file or add to a protected folder.
  void check_file(const std::filesystem::path& path) const;
  /// Throws FileError when replacing the folder at `path` would do so: when it is protected, lies in a protected
  /// folder, or holds a protected folder or file.
  void check_folder(const std::filesystem::path& path) const;

 private:
  struct Identity {
    dev_t device;
    ino_t inode;
    bool operator==(const Identity&) const = default;
  };
  struct Source {
    std::filesystem::path path;  ///< canonical
    bool is_folder;
    std::string role;
    std::vector<Identity> seen;  ///< what the path led to whenever it was added
    bool whole_may_go = false;   ///< of a folder: replacing all of it is allowed
  };
  static std::vector<Identity> identity_of(const std::filesystem::path& path);
  static bool was_seen(const Source& source, const std::vector<Identity>& there);
  static bool is_same(const Source& source, const std::filesystem::path& path);
  // With what links in it lead to.
  void add_folder(const std::filesystem::path& folder, const std::string& role);
  // False when it is known already.
  bool add_source(Source source);
  // The source that a file at the canonical path would overwrite or be added to.
  const Source* source_holding(const std::filesystem::path& wanted) const;

  std::vector<Source> sources_;
};

}  // namespace rebake
