#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "mesh_ops/base/partial_writes.h"
#include "mesh_ops/base/source_guard.h"

namespace rebake {

/// Reads a regular file of at most `most` bytes. Throws FileError, also for pipes and devices, because they might never
/// end.
std::string read_file(const std::filesystem::path& path, std::uint64_t most = std::uint64_t{8} << 30);

/// Contents of a regular file in memory. Parts that are no longer needed can be freed while the rest is in use.
class FileBytes {
 public:
  explicit FileBytes(const std::filesystem::path& path) : bytes_(read_file(path)) {}
  std::string_view view() const { return bytes_; }
  /// Returns the pages of the first `count` bytes to the system; these bytes must not be read again.
  void release(std::size_t count);

 private:
  std::string bytes_;
  std::size_t released_ = 0;
};

/// Calls `use` with the contents of a regular file in pieces of at most 1 MiB. Throws FileError.
void read_in_pieces(const std::filesystem::path& path, const std::function<void(std::string_view piece)>& use);

/// Throws FileError if ".." follows a component that is no folder. The system finds no file at such a path, although
/// its resolved form may be the path of an existing file, which checks would then miss.
void check_parents(const std::filesystem::path& path);

/// Absolute path without "." components and without a trailing slash. Symbolic links are resolved only if the path
/// contains "..", because ".." starts from the link's target.
std::filesystem::path absolute_path(const std::filesystem::path& path);

/// Reads an input that the user named: a regular file, or a pipe or character device that ends within `most` bytes.
/// Throws FileError.
std::string read_input(const std::filesystem::path& path, std::uint64_t most = std::uint64_t{256} << 20);

/// Syncs a folder's entries to disk: files created, renamed or removed in it. Throws FileError; file systems that do
/// not support it are ignored.
void sync_folder(const std::filesystem::path& folder);

/// Throws FileError if the path is a link to nothing, for example to a file on a disk that is not mounted: writing
/// would replace the link.
void refuse_dangling_link(const std::filesystem::path& path);

/// Throws FileError if the file exists and is write-protected, also for the superuser.
void refuse_write_protected(const std::filesystem::path& path);

/// Whether `name` is that of a file or folder named `of` while it is written: "OF.<8 hexadecimal
/// digits>.rebake-partial".
bool is_partial_of(const std::string& name, const std::string& of);

/// Replaces a file atomically and durably: writes and syncs a temporary file beside it, renames it, and syncs the
/// folder. Devices and pipes are written directly. Removes leftovers of killed writes. Throws FileError, also if the
/// existing file is write-protected or `guard` protects `path`.
void write_file_atomically(const std::filesystem::path& path, std::string_view bytes, const SourceGuard& guard);

/// Removes a file and syncs its folder. Throws FileError.
void remove_file(const std::filesystem::path& path);

/// A file that is open for writing at given offsets.
class OutputFile {
 public:
  /// `flags` as for open(2). Throws FileError.
  OutputFile(const std::filesystem::path& path, int flags);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  int descriptor() const { return descriptor_; }
  /// Writes all bytes at `offset` (in bytes). On failure returns false and sets errno.
  bool write_at(std::uint64_t offset, std::string_view bytes) const;
  /// Syncs the file to disk. On failure returns false and sets errno.
  bool sync() const;

 private:
  int descriptor_;
};

/// Replaces a folder atomically and durably: files are written and synced in a staging folder beside the target, and
/// commit() renames it. Without commit(), the target stays unchanged.
class AtomicFolder {
 public:
  /// `may_replace` is called if the target exists; it throws if the target's contents must not be lost. Removes
  /// leftovers of killed writes to the same target. Throws FileError if the target is a file, cannot be written or is
  /// protected by `guard`, and FieldError if `target` is empty.
  AtomicFolder(const std::filesystem::path& target, const SourceGuard& guard,
               const std::function<void(const std::filesystem::path&)>& may_replace);
  ~AtomicFolder();
  AtomicFolder(const AtomicFolder&) = delete;
  AtomicFolder& operator=(const AtomicFolder&) = delete;

  /// Writes and syncs one file at a relative path; creates folders as needed. Throws FileError (disk full, no
  /// permission).
  void write(const std::filesystem::path& relative, std::string_view bytes);
  /// As write(), for contents that are generated in pieces: `make` calls `append` with each piece.
  using Append = std::function<void(std::string_view bytes)>;
  void write_in_pieces(const std::filesystem::path& relative, const std::function<void(const Append& append)>& make);
  /// Moves the folder into place. Throws FileError, also if the target's contents must not be lost by now.
  void commit();

 private:
  /// Throws FileError if the folder at `path`, which was the target, must not be lost.
  void check_replaced(const std::filesystem::path& path) const;

  SourceGuard guard_;
  std::function<void(const std::filesystem::path&)> may_replace_;
  std::filesystem::path target_;
  std::filesystem::path staging_;
  std::unique_ptr<PartialWrite> partial_;
  int lock_ = -1;  ///< descriptor whose lock marks the staging folder as in use; −1: none
};

}  // namespace rebake
