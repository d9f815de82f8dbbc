#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rebake {

/// Folders and files that nothing may be written to: what is open came from there, and undo, journals and projects want
/// it again.
class SourceGuard {
 public:
  SourceGuard() = default;

  /// Adds a folder, or the folder of a file such as scene.json. What is not there is kept by its name.
  void add(const std::filesystem::path& source);
  /// Adds a file, not what lies beside it.
  void add_file(const std::filesystem::path& source);
  bool empty() const { return sources_.empty(); }

  /// Throws FileError when writing a file at `path` would put it into a source.
  void check_file(const std::filesystem::path& path) const;
  /// Throws FileError when replacing the folder at `path` would replace a source, or put something into one: it is a
  /// source, lies in one or holds one. Links are followed.
  void check_folder(const std::filesystem::path& path) const;

 private:
  void add_path(std::filesystem::path path);
  std::vector<std::filesystem::path> sources_;  ///< canonical
};

}  // namespace rebake
