#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace rebake {

/// The path that writing to `path` creates or replaces: canonical, without a trailing slash, through links, also those
/// to files that do not exist yet. Components that do not exist stay as named.
std::filesystem::path plain_path(const std::filesystem::path& path);

/// Files and folders that no output may overwrite, because this run reads them and undo, journals and projects read
/// them again. Existing paths are compared by device and inode, so that links, hard links, bind mounts and
/// case-insensitive file systems are recognised; paths that do not exist yet are compared by name.
class SourceGuard {
 public:
  SourceGuard() = default;

  /// Whether a folder is a scene; see protect_scene() (scene_files.h).
  using IsScene = bool (*)(const std::filesystem::path& folder);

  /// Protects a folder with its contents, and files and scenes elsewhere that links in it point to. A folder that does
  /// not exist is protected by its name.
  void add(const std::filesystem::path& folder, IsScene is_scene);
  /// Protects a file, but not its folder. `role` completes the error "is …; choose another name", for example "the
  /// script of this run".
  void add_file(const std::filesystem::path& source, const std::string& role = "a file that this run reads");
  /// Protects the contents of a scene folder, but allows replacing the whole folder: a script may import its own export
  /// and run again.
  void add_contents(const std::filesystem::path& folder, const std::string& role, IsScene is_scene);
  /// Protects all sources of another guard, without the replacements that add_contents() allows there.
  void add_all(const SourceGuard& other, const std::string& role);
  /// Undoes add_contents() after the run has replaced the folder.
  void release_contents(const std::filesystem::path& folder);
  /// Removes the protection of a folder and of all files and folders inside it.
  void release(const std::filesystem::path& folder);
  bool empty() const { return sources_.empty(); }

  /// Throws FileError if writing a file at `path` would overwrite a protected file or add to a protected folder.
  void check_file(const std::filesystem::path& path) const;
  /// Throws FileError if the folder at `path` is protected, lies in a protected folder, or contains a protected file or
  /// folder.
  void check_folder(const std::filesystem::path& path) const;

 private:
  struct Identity {
    dev_t device;
    ino_t inode;
    std::int64_t born = 0;  ///< nanoseconds; 0: the file system does not tell
    bool operator==(const Identity& other) const { return device == other.device && inode == other.inode; }
  };
  struct Source {
    std::filesystem::path path;  ///< canonical
    bool is_folder;
    std::string role;
    std::vector<Identity> seen;   ///< identity of the path's target at each time it was added
    bool replaceable = false;     ///< replacing the whole folder is allowed, see add_contents()
    std::filesystem::path owner;  ///< the folder of add_contents() that has a link to this source; empty: none
  };
  static std::vector<Identity> identity_of(const std::filesystem::path& path);
  static bool was_seen(const Source& source, const std::vector<Identity>& there);
  static bool is_same(const Source& source, const std::filesystem::path& path);
  // Adds a folder and the targets of links in it.
  void add_folder(const std::filesystem::path& folder, const std::string& role, IsScene is_scene,
                  const std::filesystem::path& owner = {});
  // Adds the targets of links in a folder: files, and scenes.
  void add_link_targets(const std::filesystem::path& folder, IsScene is_scene, const std::filesystem::path& owner);
  // Returns false if the source is known already.
  bool add_source(Source source);
  // The source that a file at canonical path `wanted` would overwrite or be added to; null if none.
  const Source* source_holding(const std::filesystem::path& wanted) const;

  std::vector<Source> sources_;
};

}  // namespace rebake
