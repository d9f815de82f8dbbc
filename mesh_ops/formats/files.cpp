#include "mesh_ops/formats/files.h"

#include <OpenImageIO/hash.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <random>
#include <regex>

#include "mesh_ops/error.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

struct Descriptor {
  int value = -1;
  ~Descriptor() {
    if (value >= 0) ::close(value);
  }
};

std::string reason() { return std::strerror(errno); }

void write_synced(const fs::path& path, std::string_view bytes) {
  Descriptor file{::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)};
  if (file.value < 0) throw FileError(path, "cannot be written: " + reason());
  while (!bytes.empty()) {
    const ssize_t written = ::write(file.value, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) throw FileError(path, "cannot be written: " + reason());
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  if (::fsync(file.value) != 0 && errno != EINVAL) throw FileError(path, "cannot be written: " + reason());
}

std::string random_suffix() {
  std::random_device device;
  return fmt::format("{:08x}", device());
}

}  // namespace

std::string read_file(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) throw FileError(path, "does not exist");
  if (fs::is_directory(status)) throw FileError(path, "is a folder, not a file");
  Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC)};
  if (file.value < 0) throw FileError(path, "cannot be read: " + reason());
  std::string bytes;
  std::size_t filled = 0;
  bytes.resize(fs::is_regular_file(status) ? fs::file_size(path, error) + 1 : 65536);
  for (;;) {
    if (filled == bytes.size()) bytes.resize(bytes.size() * 2);
    const ssize_t got = ::read(file.value, bytes.data() + filled, bytes.size() - filled);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw FileError(path, "cannot be read: " + reason());
    if (got == 0) break;
    filled += static_cast<std::size_t>(got);
  }
  bytes.resize(filled);
  return bytes;
}

std::uint64_t content_hash(std::string_view bytes) { return OIIO::xxhash::xxhash(bytes.data(), bytes.size(), 0); }

bool is_format_file_name(const std::string& name) {
  static const std::regex pattern(
      R"(mlp\.json|scene\.json|turns\.json|shape\d*(_\d+)?\.obj|shape\d*\.pngfeat[01]\.png)");
  return std::regex_match(name, pattern);
}

AtomicFolder::AtomicFolder(fs::path target) : target_(std::move(target)) {
  target_ = fs::absolute(target_).lexically_normal();
  if (!target_.has_filename()) target_ = target_.parent_path();
  std::error_code error;
  if (fs::exists(target_, error)) {
    if (!fs::is_directory(target_)) throw FileError(target_, "is a file; name a folder to write to");
    // Replacing the folder must never lose what is not ours.
    for (auto it = fs::recursive_directory_iterator(target_, error); !error && it != fs::recursive_directory_iterator();
         it.increment(error)) {
      const bool folder_of_scene = it->is_directory() && it.depth() == 0;
      if (!folder_of_scene && !is_format_file_name(it->path().filename().string()))
        throw FileError(target_,
                        fmt::format("holds \"{}\", which is not part of a baked scene; choose a new or empty folder",
                                    fs::relative(it->path(), target_).string()));
    }
    if (error) throw FileError(target_, "cannot be read: " + error.message());
    if (::access(target_.c_str(), W_OK) != 0) throw FileError(target_, "cannot be written: " + reason());
  }
  fs::create_directories(target_.parent_path(), error);
  if (error) throw FileError(target_.parent_path(), "cannot be created: " + error.message());
  staging_ = target_.parent_path() / ("." + target_.filename().string() + "." + random_suffix() + ".partial");
  if (!fs::create_directory(staging_, error) || error)
    throw FileError(target_, "cannot be written: " + error.message());
}

AtomicFolder::~AtomicFolder() {
  std::error_code ignored;
  if (!staging_.empty()) fs::remove_all(staging_, ignored);
}

void AtomicFolder::write(const fs::path& relative, std::string_view bytes) {
  const fs::path path = staging_ / relative;
  std::error_code error;
  fs::create_directories(path.parent_path(), error);
  if (error) throw FileError(path.parent_path(), "cannot be created: " + error.message());
  write_synced(path, bytes);
}

void AtomicFolder::commit() {
  if (fs::exists(target_)) {
    // One system call swaps old and new; the old one, now at the staging path, is removed by the destructor.
    if (::renameat2(AT_FDCWD, staging_.c_str(), AT_FDCWD, target_.c_str(), RENAME_EXCHANGE) == 0) return;
    if (errno != EINVAL && errno != ENOSYS) throw FileError(target_, "cannot be replaced: " + reason());
    const fs::path old = staging_.string() + ".old";
    fs::rename(target_, old);
    fs::rename(staging_, target_);
    staging_ = old;
    return;
  }
  if (::rename(staging_.c_str(), target_.c_str()) != 0) throw FileError(target_, "cannot be written: " + reason());
  staging_.clear();
}

void write_file_atomically(const fs::path& path, std::string_view bytes) {
  if (path.has_parent_path() && !fs::is_directory(path.parent_path()))
    throw FileError(path.parent_path(), "is not a folder; create it first");
  if (fs::is_directory(path)) throw FileError(path, "is a folder; name a file to write to");
  const fs::path partial = path.string() + "." + random_suffix() + ".partial";
  try {
    write_synced(partial, bytes);
    if (::rename(partial.c_str(), path.c_str()) != 0) throw FileError(path, "cannot be written: " + reason());
  } catch (...) {
    std::error_code ignored;
    fs::remove(partial, ignored);
    throw;
  }
}

}  // namespace rebake
