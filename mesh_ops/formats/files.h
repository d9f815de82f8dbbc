#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace rebake {

/// All bytes of a regular file. Throws FileError.
std::string read_file(const std::filesystem::path& path);

/// XXH64, seed 0.
std::uint64_t content_hash(std::string_view bytes);

/// Names and bytes of the files of a scene folder (those whose names belong to the formats, folders within included),
/// in one number; scene.json stands for its folder. Throws FileError.
std::uint64_t folder_hash(const std::filesystem::path& folder);

/// A folder that appears whole or not at all: files are written beside the target and moved into place by commit().
/// Destroyed without commit, it leaves what was there before.
class AtomicFolder {
 public:
  /// Throws FileError when the target is a file, cannot be written, or holds files that Rebake did not put there
  /// (names other than those of the formats), since replacing it would lose them.
  explicit AtomicFolder(std::filesystem::path target);
  ~AtomicFolder();
  AtomicFolder(const AtomicFolder&) = delete;
  AtomicFolder& operator=(const AtomicFolder&) = delete;

  /// Where to write. Folders below it are made by write().
  const std::filesystem::path& staging() const { return staging_; }
  /// Writes and syncs one file at a relative path. Throws FileError (disk full, no permission).
  void write(const std::filesystem::path& relative, std::string_view bytes);
  void commit();

 private:
  std::filesystem::path target_;
  std::filesystem::path staging_;
};

/// Writes one file whole or not at all (a temporary beside it, then a rename). Throws FileError.
void write_file_atomically(const std::filesystem::path& path, std::string_view bytes);

/// True for file names that belong to a MobileNeRF folder or a Rebake scene.
bool is_format_file_name(const std::string& name);

}  // namespace rebake
