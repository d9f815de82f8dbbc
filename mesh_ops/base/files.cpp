#include "mesh_ops/base/files.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <optional>
#include <random>
#include <set>
#include <thread>
#include <utility>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/file_calls.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/base/partial_writes.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

struct Descriptor {
  explicit Descriptor(int opened) : value(opened) {}
  Descriptor(Descriptor&& other) noexcept : value(std::exchange(other.value, -1)) {}
  Descriptor& operator=(Descriptor&&) = delete;
  ~Descriptor() {
    if (value >= 0) ::close(value);
  }
  int value;
};

std::string reason() { return std::strerror(errno); }

[[noreturn]] void fail(const fs::path& path, const std::string& what) { throw FileError(path, what + ": " + reason()); }

std::string megabytes(std::uint64_t bytes) { return std::to_string(bytes >> 20) + " MB"; }

// Reads to the end of the file. `expected`: likely size in bytes. Throws FileError beyond `most` bytes.
std::string load_scenes(const fs::path& path, int file, std::uint64_t expected, std::uint64_t most) {
  std::string bytes;
  std::size_t filled = 0;
  bytes.resize(expected + 1);
  for (;;) {
    if (filled == bytes.size()) bytes.resize(bytes.size() * 2);
    const ssize_t got = ::read(file, bytes.data() + filled, bytes.size() - filled);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail(path, "cannot be read");
    if (got == 0) break;
    filled += static_cast<std::size_t>(got);
    if (filled > most) throw FileError(path, "is larger than " + megabytes(most) + ", the size limit for reading");
  }
  bytes.resize(filled);
  return bytes;
}

// A file opened for reading; `size` in bytes is set for regular files only.
struct Input {
  Descriptor file;
  std::optional<std::uint64_t> size;
};

Input open_input(const fs::path& path, bool pipes) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) throw FileError(path, "does not exist");
  if (fs::is_directory(status)) throw FileError(path, "is a folder, not a file");
  const bool regular = fs::is_regular_file(status), pipe = fs::is_fifo(status) || fs::is_character_file(status);
  if (!regular && !(pipes && pipe)) throw FileError(path, "is not a regular file (it is a pipe, a device or a socket)");
  // O_NONBLOCK: open() must not block if a pipe has replaced the file since the check.
  Input input{Descriptor(::open(path.c_str(), O_RDONLY | O_CLOEXEC | (regular ? O_NONBLOCK : 0))), std::nullopt};
  struct stat about {};
  if (input.file.value < 0 || ::fstat(input.file.value, &about) != 0) fail(path, "cannot be read");
  if (regular && !S_ISREG(about.st_mode)) throw FileError(path, "is no longer a regular file");
  if (regular) input.size = static_cast<std::uint64_t>(about.st_size);
  return input;
}

std::string read_some(const fs::path& path, std::uint64_t most, bool pipes) {
  const Input input = open_input(path, pipes);
  if (input.size.value_or(0) > most)
    throw FileError(path, "is larger than " + megabytes(most) + ", the size limit for reading");
  return load_scenes(path, input.file.value, input.size.value_or(65536), most);
}

void write_synced(const fs::path& path, int flags, const std::function<void(const AtomicFolder::Append&)>& make) {
  const OutputFile file(path, O_WRONLY | O_CREAT | flags);
  // The lock tells other processes that this file is not a leftover.
  ::flock(file.descriptor(), LOCK_SH | LOCK_NB);
  std::uint64_t size = 0;
  make([&](std::string_view bytes) {
    if (!file.write_at(size, bytes)) fail(path, "cannot be written");
    size += bytes.size();
  });
  if (!file.sync()) fail(path, "cannot be written");
}

void write_synced(const fs::path& path, std::string_view bytes, int flags) {
  write_synced(path, flags, [&](const AtomicFolder::Append& append) { append(bytes); });
}

// Programs that download files use other endings.
constexpr std::string_view partial_ending = ".rebake-partial";

// Temporary name of a file or folder that is being written: see is_partial_of().
std::string partial_name(const std::string& name) {
  std::random_device device;
  std::string result = name;
  result.append(".").append(hash_text(device()), 8).append(partial_ending);
  return result;
}

// True if a file system is mounted at the path or below it; its files must not be removed.
bool holds_mount(const fs::path& path) {
  const auto is_mount = [](const fs::path& at) {
    struct statx about {};
    return ::statx(AT_FDCWD, at.c_str(), AT_SYMLINK_NOFOLLOW, STATX_BASIC_STATS, &about) != 0 ||
           (about.stx_attributes & about.stx_attributes_mask & STATX_ATTR_MOUNT_ROOT) != 0;
  };
  if (is_mount(path)) return true;
  std::error_code error;
  for (fs::recursive_directory_iterator at(path, error), end; !error && at != end; at.increment(error))
    if (at->is_directory(error) && is_mount(at->path())) return true;
  return false;
}

// The removal of a replaced folder would delete the files of a file system that is mounted in it.
void refuse_mounts(const fs::path& folder) {
  if (holds_mount(folder))
    throw FileError(folder,
                    "has a file system mounted in it, whose files would be lost; unmount it, or choose another folder");
}

bool is_source(const fs::path& path, const SourceGuard& guard) {
  try {
    guard.check_folder(path);
    guard.check_file(path / "any file");  // also protects sources that may be replaced as a whole
    return false;
  } catch (const FileError&) {
    return true;
  }
}

// Removes leftovers of killed processes; a running process holds a lock on its files. Skips the sources of this run,
// because users open leftovers to rescue them.
void remove_leftovers(const fs::path& folder, const std::string& of, bool are_folders, const SourceGuard& guard) {
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    if (!is_partial_of(at->path().filename().string(), of)) continue;
    std::error_code ignored;
    if (fs::is_directory(at->symlink_status(ignored)) != are_folders) continue;
    const Descriptor lock{::open(at->path().c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW)};
    if (lock.value < 0 || ::flock(lock.value, LOCK_EX | LOCK_NB) != 0) continue;
    if (is_source(at->path(), guard) || holds_mount(at->path())) continue;
    fs::remove_all(at->path(), ignored);
  }
}

// Creates a folder and its parents, and syncs each parent, so that the new entries survive a power loss.
void make_folders(const fs::path& folder) {
  if (folder.empty() || fs::is_directory(folder)) return;
  make_folders(folder.parent_path());
  if (file_calls().mkdir(folder.c_str(), 0777) != 0 && errno != EEXIST) fail(folder, "cannot be created");
  if (!fs::is_directory(folder)) throw FileError(folder, "is not a folder");
  sync_folder(folder.parent_path());
}

// Opens a pipe for writing and waits up to 5 s for its reader; a blocking open() would wait forever.
int open_pipe(const fs::path& pipe) {
  constexpr std::chrono::seconds patience(5);
  constexpr std::chrono::milliseconds pause(20);
  for (const auto end = std::chrono::steady_clock::now() + patience;;) {
    const int opened = ::open(pipe.c_str(), O_WRONLY | O_CLOEXEC | O_NONBLOCK);
    if (opened >= 0) {
      ::fcntl(opened, F_SETFL, ::fcntl(opened, F_GETFL) & ~O_NONBLOCK);
      return opened;
    }
    if (errno != ENXIO && errno != EINTR) fail(pipe, "cannot be written");
    if (std::chrono::steady_clock::now() > end)
      throw FileError(pipe, "is a pipe that no program reads; start its reader first, or name a file");
    std::this_thread::sleep_for(pause);
  }
}

// Refuses to replace a folder with write-protected files, and the current folder: relative paths would end in the old
// one, which is deleted.
void refuse_replacing_folder(const fs::path& folder) {
  refuse_write_protected(folder);
  std::error_code error;
  for (auto entry = fs::recursive_directory_iterator(folder, error); !error && entry != fs::end(entry);
       entry.increment(error))
    if (!entry->is_symlink(error)) refuse_write_protected(entry->path());
  for (fs::path at = fs::current_path(error); !error && !at.empty(); at = at.parent_path()) {
    if (fs::equivalent(at, folder, error))
      throw FileError(folder, "is the current folder, or contains it, so it cannot be replaced; write to a new folder");
    if (at == at.parent_path()) break;
  }
}

// Resolves symbolic links: the target of a link is replaced, not the link.
fs::path followed(const fs::path& path) {
  std::error_code error;
  fs::path target = fs::weakly_canonical(fs::absolute(path), error);
  if (error) throw FileError(path, "cannot be resolved: " + error.message());
  return target.has_filename() ? target : target.parent_path();
}

}  // namespace

std::string read_file(const fs::path& path, std::uint64_t most) { return read_some(path, most, false); }

void FileBytes::release(std::size_t count) {
  const auto page = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
  const auto begin = reinterpret_cast<std::uintptr_t>(bytes_.data());
  const std::uintptr_t first = (begin + released_ + page - 1) / page * page;
  const std::uintptr_t last = (begin + std::min(count, bytes_.size())) / page * page;
  if (first >= last) return;
  ::madvise(reinterpret_cast<void*>(first), last - first, MADV_DONTNEED);  // only a hint: failure is harmless
  released_ = last - begin;
}

void read_in_pieces(const fs::path& path, const std::function<void(std::string_view)>& use) {
  const Input input = open_input(path, false);
  std::string piece(std::size_t{1} << 20, '\0');
  for (;;) {
    const ssize_t got = ::read(input.file.value, piece.data(), piece.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail(path, "cannot be read");
    if (got == 0) return;
    use(std::string_view(piece).substr(0, static_cast<std::size_t>(got)));
  }
}

void check_parents(const fs::path& path) {
  fs::path before;
  for (const fs::path& part : path) {
    std::error_code error;
    if (part == ".." && !before.empty() && !fs::is_directory(before, error))
      throw FileError(path, "cannot be written: \"" + before.string() + "\" is not a folder");
    before /= part;
  }
}

fs::path absolute_path(const fs::path& path) {
  fs::path result = fs::absolute(path);
  if (std::find(result.begin(), result.end(), "..") != result.end()) {
    std::error_code error;
    const fs::path resolved = fs::weakly_canonical(result, error);
    if (!error) result = resolved;
  }
  result = result.lexically_normal();
  return result.has_filename() || !result.has_relative_path() ? result : result.parent_path();
}

std::string read_input(const fs::path& path, std::uint64_t most) { return read_some(path, most, true); }

OutputFile::OutputFile(const fs::path& path, int flags)
    : descriptor_(file_calls().open(path.c_str(), flags | O_CLOEXEC, 0666)) {
  if (descriptor_ < 0) fail(path, "cannot be written");
}
OutputFile::~OutputFile() { file_calls().close(descriptor_); }

bool OutputFile::write_at(std::uint64_t offset, std::string_view bytes) const {
  while (!bytes.empty()) {
    const ssize_t written = file_calls().pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written == 0) errno = ENOSPC;
    if (written <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(written));
    offset += static_cast<std::uint64_t>(written);
  }
  return true;
}

bool OutputFile::sync() const {
  int result = 0;
  do result = file_calls().fsync(descriptor_);
  while (result != 0 && errno == EINTR);
  return result == 0 || errno == EINVAL;  // pipes have nothing to sync
}

void sync_folder(const fs::path& folder) {
  const fs::path named = folder.empty() ? fs::path(".") : folder;
  const int descriptor = file_calls().open(named.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC, 0);
  if (descriptor < 0) fail(named, "cannot be synced to disk");
  const bool done = file_calls().fsync(descriptor) == 0 || errno == EINVAL || errno == ENOTSUP;
  const int error = errno;
  file_calls().close(descriptor);
  errno = error;
  if (!done) fail(named, "cannot be synced to disk");
}

void refuse_dangling_link(const fs::path& path) {
  std::error_code error;
  if (fs::is_symlink(path, error) && !fs::exists(path, error))
    throw FileError(
        path,
        "is a link to a file or folder that does not exist, for example on a disk that is not mounted; remove the "
        "link, or name another file");
}

// A rename checks only the folder's permission, so the file's own is checked here. The mode bits count too, because the
// superuser may write every file.
void refuse_write_protected(const fs::path& path) {
  struct stat about {};
  if (file_calls().stat(path.c_str(), &about) != 0) return;
  if ((about.st_mode & (S_IWUSR | S_IWGRP | S_IWOTH)) == 0 || ::access(path.c_str(), W_OK) != 0)
    throw FileError(path, "is write-protected; choose another name, or make it writable first");
}

bool is_partial_of(const std::string& name, const std::string& of) {
  if (name.size() != of.size() + 9 + partial_ending.size() || !name.starts_with(of) || !name.ends_with(partial_ending))
    return false;
  const std::string digits = name.substr(of.size(), 9);
  return digits[0] == '.' && digits.find_first_not_of("0123456789abcdef", 1) == std::string::npos;
}

void write_file_atomically(const fs::path& named, std::string_view bytes, const SourceGuard& guard) {
  if (const fs::path name = named.filename(); name.empty() || name == "." || name == "..")
    throw FileError(named, "must be the name of a file, without a slash or dot at its end");
  check_parents(named);
  guard.check_file(named);
  refuse_dangling_link(named);
  const fs::path path = followed(named);
  std::error_code error;
  if (path.has_parent_path() && !fs::is_directory(path.parent_path(), error))
    throw FileError(named.parent_path(), "is not a folder; create it first");
  if (fs::is_directory(path)) throw FileError(named, "is a folder; name a file to write to");
  if (fs::exists(path) && !fs::is_regular_file(path)) {
    // Devices and pipes are written directly: a rename would replace them by a file.
    const Descriptor file{fs::is_fifo(path) ? open_pipe(named) : ::open(path.c_str(), O_WRONLY | O_CLOEXEC)};
    if (file.value < 0) fail(path, "cannot be written");
    std::size_t written = 0;
    while (written < bytes.size()) {
      const ssize_t more = ::write(file.value, bytes.data() + written, bytes.size() - written);
      if (more < 0 && errno == EINTR) continue;
      if (more <= 0) fail(path, "cannot be written");
      written += static_cast<std::size_t>(more);
    }
    return;
  }
  refuse_write_protected(path);
  remove_leftovers(path.parent_path(), path.filename().string(), false, guard);
  const fs::path partial = path.parent_path() / partial_name(path.filename().string());
  const PartialWrite known(partial);
  try {
    write_synced(partial, bytes, O_EXCL);
    const auto committing = PartialWrite::committing();
    if (file_calls().rename(partial.c_str(), path.c_str(), 0) != 0) fail(path, "cannot be written");
  } catch (...) {
    std::error_code ignored;
    fs::remove(partial, ignored);
    throw;
  }
  sync_folder(path.parent_path());
}

void remove_file(const fs::path& path) {
  if (file_calls().unlink(path.c_str()) != 0) fail(path, "cannot be removed");
  sync_folder(path.parent_path());
}

AtomicFolder::AtomicFolder(const fs::path& target, const SourceGuard& guard,
                           const std::function<void(const fs::path&)>& may_replace)
    : guard_(guard), may_replace_(may_replace) {
  if (target.empty()) throw FieldError("out", "is empty; name a folder to write to");
  guard.check_folder(target);
  check_parents(target);
  refuse_dangling_link(target);
  target_ = followed(target);
  std::error_code error;
  if (fs::exists(target_, error)) {
    if (!fs::is_directory(target_)) throw FileError(target_, "is a file; name a folder to write to");
    may_replace_(target_);
    refuse_mounts(target_);
    refuse_replacing_folder(target_);
  }
  make_folders(target_.parent_path());
  std::string hidden = ".";
  hidden += target_.filename().string();
  remove_leftovers(target_.parent_path(), hidden, true, guard);
  staging_ = target_.parent_path() / partial_name(hidden);
  if (file_calls().mkdir(staging_.c_str(), 0777) != 0) {
    staging_.clear();
    fail(target_, "cannot be written");
  }
  partial_ = std::make_unique<PartialWrite>(staging_);
  lock_ = ::open(staging_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (lock_ >= 0) ::flock(lock_, LOCK_SH | LOCK_NB);
}

AtomicFolder::~AtomicFolder() {
  std::error_code ignored;
  if (!staging_.empty()) fs::remove_all(staging_, ignored);
  if (lock_ >= 0) ::close(lock_);
}

void AtomicFolder::write(const fs::path& relative, std::string_view bytes) {
  write_in_pieces(relative, [&](const Append& append) { append(bytes); });
}

void AtomicFolder::write_in_pieces(const fs::path& relative, const std::function<void(const Append&)>& make) {
  PartialWrite::committing().unlock();  // blocks forever after abandon_writes(), which removes the folder
  const fs::path path = staging_ / relative;
  make_folders(path.parent_path());
  write_synced(path, O_TRUNC, make);
}

void AtomicFolder::check_replaced(const fs::path& path) const {
  refuse_mounts(path);
  try {
    may_replace_(path);
  } catch (const FileError&) {
    throw FileError(target_, "received other files while the new contents were written; choose a new or empty folder");
  }
}

void AtomicFolder::commit() {
  PartialWrite::committing().unlock();  // blocks forever after abandon_writes()
  // Subfolders are synced before the folders that contain them, and all of them before the rename.
  std::set<fs::path> folders{staging_};
  for (const auto& entry : fs::recursive_directory_iterator(staging_))
    if (entry.is_directory()) folders.insert(entry.path());
  for (auto folder = folders.rbegin(); folder != folders.rend(); ++folder) sync_folder(*folder);
  fs::path old;
  const auto committing = PartialWrite::committing();
  // Checked again: a parent folder may have become a link to a source since.
  guard_.check_folder(target_);
  if (fs::exists(target_)) {
    // One system call exchanges old and new; the destructor removes the old folder, now at the staging path.
    if (file_calls().rename(staging_.c_str(), target_.c_str(), RENAME_EXCHANGE) == 0) {
      // Other programs may have written files there since the check at the beginning.
      try {
        check_replaced(staging_);
      } catch (...) {
        if (file_calls().rename(staging_.c_str(), target_.c_str(), RENAME_EXCHANGE) == 0) throw;
        // The old folder keeps a name that no clean-up removes.
        const fs::path aside = staging_.string() + ".old";
        const bool moved = file_calls().rename(staging_.c_str(), aside.c_str(), 0) == 0;
        const fs::path kept = moved ? aside : staging_;
        staging_.clear();
        throw FileError(target_, "received other files while it was replaced; they are in " + kept.string());
      }
      old = staging_;
    } else {
      if (errno != EINVAL && errno != ENOSYS) fail(target_, "cannot be replaced");
      // Two renames if the file system cannot exchange; between them, the old folder is at `aside`.
      const fs::path aside = staging_.string() + ".old";  // not named like a leftover: it may be the only copy
      check_replaced(target_);
      if (file_calls().rename(target_.c_str(), aside.c_str(), 0) != 0) fail(target_, "cannot be replaced");
      if (file_calls().rename(staging_.c_str(), target_.c_str(), 0) != 0) {
        const int error = errno;
        file_calls().rename(aside.c_str(), target_.c_str(), 0);
        errno = error;
        fail(target_, "cannot be replaced");
      }
      old = aside;
    }
  } else if (file_calls().rename(staging_.c_str(), target_.c_str(), 0) != 0) {
    fail(target_, "cannot be written");
  }
  staging_ = old;
  sync_folder(target_.parent_path());
}

}  // namespace rebake
