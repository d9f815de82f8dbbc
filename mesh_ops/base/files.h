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

/// All bytes of a regular file of at most `most` bytes. Throws FileError, also for pipes and devices, which might never
/// end.
std::string read_file(const std::filesystem::path& path, std::uint64_t most = std::uint64_t{8} << 30);

/// All bytes of a regular file, as read_file() reads them. The memory of those that are not needed any more can be
/// freed while the rest is still in use.
class FileBytes {
 public:
  explicit FileBytes(const std::filesystem::path& path) : bytes_(read_file(path)) {}
  std::string_view view() const { return bytes_; }
  /// The first `count` bytes, which are not read again: their pages go back to the system.
  void release(std::size_t count);

 private:
  std::string bytes_;
  std::size_t released_ = 0;
};

/// Calls `use` with all bytes of a regular file, a megabyte at a time. Throws FileError.
void read_in_pieces(const std::filesystem::path& path, const std::function<void(std::string_view piece)>& use);

/// The absolute path without dots and a slash at the end. Links stay, but in a path with "..": there they are followed,
/// since ".." leads up from what a link points to.
std::filesystem::path absolute_path(const std::filesystem::path& path);

/// What a person names as input: a regular file, or a pipe that ends within `most` bytes. Throws FileError.
std::string read_input(const std::filesystem::path& path, std::uint64_t most = std::uint64_t{256} << 20);

/// Asks the system to have a folder's entries on the disk: files that were made, renamed or removed there. Throws
/// FileError; file systems that cannot are let pass.
void sync_folder(const std::filesystem::path& folder);

/// Writes one file whole or not at all, on the disk when this returns: a temporary beside it, synced, then a rename,
/// and the folder synced. Devices and pipes are written to. Leftovers of such writes that were killed are removed.
/// Throws FileError, also where a write-protected file is there; `guard` says where nothing may be written.
void write_file_atomically(const std::filesystem::path& path, std::string_view bytes, const SourceGuard& guard);

/// Removes a file that is not wanted any more, on the disk when this returns. Throws FileError.
void remove_file(const std::filesystem::path& path);

/// An open file, to be written at given places.
class OutputFile {
 public:
  /// `flags` as of open(2). Throws FileError with `reason` about the path.
  OutputFile(const std::filesystem::path& path, int flags);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  int descriptor() const { return descriptor_; }
  /// Writes all bytes at an offset. False with errno set where that fails.
  bool write_at(std::uint64_t offset, std::string_view bytes) const;
  /// False with errno set where the disk does not take it.
  bool sync() const;

 private:
  int descriptor_;
};

/// A folder that appears whole or not at all, and on the disk: files are written and synced beside the target and moved
/// into place by commit(). Destroyed without commit, it leaves what was there before.
class AtomicFolder {
 public:
  /// `may_replace` throws when the target holds something that must not be lost; it is asked only where the target is
  /// there. Leftovers of writes to the same target that were killed are removed. Throws FileError when the target is a
  /// file, cannot be written, or `guard` refuses.
  AtomicFolder(const std::filesystem::path& target, const SourceGuard& guard,
               const std::function<void(const std::filesystem::path&)>& may_replace);
  ~AtomicFolder();
  AtomicFolder(const AtomicFolder&) = delete;
  AtomicFolder& operator=(const AtomicFolder&) = delete;

  /// Writes and syncs one file at a relative path; folders are made as needed. Throws FileError (disk full, no
  /// permission).
  void write(const std::filesystem::path& relative, std::string_view bytes);
  /// The same for bytes that are made one after the other: `make` calls `append` with them.
  using Append = std::function<void(std::string_view bytes)>;
  void write_in_pieces(const std::filesystem::path& relative, const std::function<void(const Append& append)>& make);
  void commit();

 private:
  SourceGuard guard_;
  std::filesystem::path target_;
  std::filesystem::path staging_;
  std::unique_ptr<PartialWrite> partial_;
  int lock_ = -1;  ///< held on the staging folder, so that nobody takes it for a leftover
};

}  // namespace rebake
