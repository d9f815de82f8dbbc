#include "mesh_ops/formats/files.h"

#include <OpenImageIO/hash.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <regex>
#include <set>
#include <vector>

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

// The object folders that a folder's own scene.json names.
std::set<std::string> named_folders(const fs::path& folder) {
  std::set<std::string> names;
  if (!fs::exists(folder / "scene.json")) return names;
  const nlohmann::json scene = nlohmann::json::parse(read_file(folder / "scene.json"), nullptr, false);
  if (!scene.is_object() || !scene.contains("rebake_scene")) return names;
  std::vector<const nlohmann::json*> open{&scene};
  while (!open.empty()) {
    const nlohmann::json& value = *open.back();
    open.pop_back();
    for (const char* key : {"nodes", "children"})
      if (value.is_object() && value.contains(key) && value.at(key).is_array())
        for (const nlohmann::json& child : value.at(key)) open.push_back(&child);
    if (value.is_object() && value.contains("folder") && value.at("folder").is_string())
      names.insert(value.at("folder").get<std::string>());
  }
  return names;
}

// Replacing a folder must never lose what is not part of the scene in it.
void refuse_foreign_content(const fs::path& folder) {
  const std::set<std::string> own = named_folders(folder);
  const auto refuse = [&](const fs::path& path) {
    throw FileError(folder,
                    fmt::format("holds \"{}\", which is not part of the scene there; choose a new or empty folder",
                                path.lexically_relative(folder).string()));
  };
  std::error_code error;
  for (auto it = fs::recursive_directory_iterator(folder, error); !error && it != fs::recursive_directory_iterator();
       it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (it->is_symlink()) refuse(it->path());
    if (it->is_directory() ? it.depth() > 0 || !own.contains(name) : !is_format_file_name(name)) refuse(it->path());
  }
  if (error) throw FileError(folder, "cannot be read: " + error.message());
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
  if (target_.empty()) throw FieldError("out", "names no folder to write to");
  std::error_code error;
  // Through symbolic links: what they point to is replaced, not the link.
  target_ = fs::weakly_canonical(fs::absolute(target_), error);
  if (error) throw FileError(target_, "cannot be reached: " + error.message());
  if (!target_.has_filename()) target_ = target_.parent_path();
  if (fs::exists(target_, error)) {
    if (!fs::is_directory(target_)) throw FileError(target_, "is a file; name a folder to write to");
    refuse_foreign_content(target_);
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
    std::error_code error;
    fs::rename(staging_, target_, error);
    if (error) {
      fs::rename(old, target_);
      throw FileError(target_, "cannot be replaced: " + error.message());
    }
    staging_ = old;
    return;
  }
  if (::rename(staging_.c_str(), target_.c_str()) != 0) throw FileError(target_, "cannot be written: " + reason());
  staging_.clear();
}

void write_file_atomically(const fs::path& named, std::string_view bytes) {
  std::error_code error;
  // Through symbolic links: what they point to is replaced, not the link.
  const fs::path path = fs::weakly_canonical(fs::absolute(named), error);
  if (error) throw FileError(named, "cannot be reached: " + error.message());
  if (path.has_parent_path() && !fs::is_directory(path.parent_path(), error))
    throw FileError(named.parent_path(), "is not a folder; create it first");
  if (fs::is_directory(path)) throw FileError(named, "is a folder; name a file to write to");
  if (fs::exists(path) && !fs::is_regular_file(path)) {
    // Devices and pipes are written to; a rename would put a file in their place.
    write_synced(path, bytes);
    return;
  }
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

std::uint64_t folder_hash(const fs::path& path) {
  const fs::path folder = path.filename() == "scene.json" ? path.parent_path() : path;
  std::error_code error;
  if (!fs::is_directory(folder, error)) throw FileError(path, "is not there, or is not a folder");
  std::map<std::string, fs::path> files;
  for (auto it = fs::recursive_directory_iterator(folder, error); !error && it != fs::recursive_directory_iterator();
       it.increment(error))
    if (it->is_regular_file() && is_format_file_name(it->path().filename().string()))
      files.emplace(it->path().lexically_relative(folder).generic_string(), it->path());
  if (error) throw FileError(folder, "cannot be read: " + error.message());
  std::string all;
  for (const auto& [name, file] : files) all += fmt::format("{} {:016x}\n", name, content_hash(read_file(file)));
  return content_hash(all);
}

}  // namespace rebake
