#include "editor/document/result_store.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <utility>
#include <vector>

#include "editor/document/user_folder.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/base/hash.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t header_bytes = 16;  // length of the checksum at the start of a file, in hexadecimal digits
constexpr const char* extension = ".result";

// Whether a name before its first dot is a key of result_key(): "KIND-<32 hexadecimal digits>".
bool is_own_name(const std::string& stem) {
  constexpr std::size_t digits = 32;
  return stem.size() > digits && stem[stem.size() - digits - 1] == '-' &&
         stem.find_first_not_of("0123456789abcdef", stem.size() - digits) == std::string::npos;
}

}  // namespace

ResultStore::ResultStore(fs::path folder, std::uint64_t limit) : folder_(std::move(folder)), limit_(limit) {}

std::shared_ptr<ResultStore> ResultStore::user_store() {
  if (const char* chosen = std::getenv("REBAKE_RESULTS"))
    return *chosen != '\0' ? std::make_shared<ResultStore>(absolute_path(chosen)) : nullptr;
  const auto cache = user_folder("XDG_CACHE_HOME", ".cache");
  return cache ? std::make_shared<ResultStore>(*cache / "rebake" / "results") : nullptr;
}

std::optional<std::string> ResultStore::find(const std::string& key) {
  const fs::path path = folder_ / (key + extension);
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return std::nullopt;
  try {
    std::string bytes = read_file(path);
    if (bytes.size() < header_bytes ||
        hash_text(content_hash(std::string_view(bytes).substr(header_bytes))) != bytes.substr(0, header_bytes)) {
      fs::remove(path, error);
      return std::nullopt;
    }
    fs::last_write_time(path, fs::file_time_type::clock::now(), error);
    ++found_;
    return bytes.substr(header_bytes);
  } catch (const std::exception&) {
    return std::nullopt;  // another program removed it
  }
}

void ResultStore::keep(const std::string& key, std::string_view bytes) {
  if (bytes.size() + header_bytes > limit_) return;
  const std::scoped_lock lock(mutex_);
  try {
    std::error_code error;
    fs::create_directories(folder_, error);
    write_file_atomically(folder_ / (key + extension), hash_text(content_hash(bytes)) + std::string(bytes), {});
    evict_to_limit();
  } catch (const std::exception&) {
    // A full disk or a read-only folder: the result is computed again next time.
  }
}

// Removes the least recently used files until the rest fits.
void ResultStore::evict_to_limit() const {
  struct Kept {
    fs::file_time_type used;
    fs::path path;
    std::uint64_t bytes;
  };
  std::vector<Kept> files;
  std::uint64_t total = 0;
  std::error_code error;
  for (fs::directory_iterator at(folder_, error), end; !error && at != end; at.increment(error)) {
    const fs::directory_entry& entry = *at;
    std::error_code gone;
    const auto used = entry.last_write_time(gone);
    // A temporary file of a killed program: no write takes an hour.
    const std::string name = entry.path().filename().string();
    if (!is_own_name(name.substr(0, name.find('.')))) continue;
    if (!gone && (entry.path().extension() == ".rebake-partial" || entry.path().extension() == ".partial") &&
        fs::file_time_type::clock::now() - used > std::chrono::hours(1))
      fs::remove(entry.path(), gone);
    if (entry.path().extension() != extension) continue;
    const std::uint64_t bytes = entry.file_size(gone);
    if (gone) continue;
    files.push_back({used, entry.path(), bytes});
    total += bytes;
  }
  std::sort(files.begin(), files.end(), [](const Kept& a, const Kept& b) { return a.used < b.used; });
  for (const Kept& file : files) {
    if (total <= limit_) return;
    fs::remove(file.path, error);
    total -= file.bytes;
  }
}

}  // namespace rebake
