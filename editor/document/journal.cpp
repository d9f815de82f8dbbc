#include "editor/document/journal.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "mesh_ops/error.h"
#include "mesh_ops/formats/files.h"

namespace rebake {

using nlohmann::json;
namespace fs = std::filesystem;

namespace {

constexpr int version = 1;
constexpr std::size_t digits = 16;

std::string line_of(const json& entry) {
  const std::string text = entry.dump();
  return fmt::format("{:016x} {}\n", content_hash(text), text);
}

void sync_folder_of(const fs::path& path) {
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;  // the file itself is synced; some file systems refuse this for folders
  ::fsync(descriptor);
  ::close(descriptor);
}

}  // namespace

class Journal::File {
 public:
  File(fs::path path, int flags, std::uint64_t end, std::uint64_t next)
      : path_(std::move(path)),
        descriptor_(::open(path_.c_str(), flags | O_WRONLY | O_CLOEXEC, 0666)),
        end_(end),
        next_(next) {
    if (descriptor_ < 0 && errno == EEXIST)
      throw FileError(path_, "is there already and may hold work: get it back with \"rebake recover\", or remove it");
    if (descriptor_ < 0) throw FileError(path_, std::string("cannot be written: ") + std::strerror(errno));
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
      ::close(descriptor_);
      throw FileError(path_, "is being written by another Rebake");
    }
    if (::ftruncate(descriptor_, static_cast<off_t>(end_)) != 0) fail();
  }
  ~File() { ::close(descriptor_); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  void append(std::vector<json> entries) {
    std::string lines;
    std::uint64_t next = next_;
    for (json& entry : entries) {
      if (next > 0) entry["n"] = next;
      lines += line_of(entry);
      ++next;
    }
    std::string_view rest = lines;
    while (!rest.empty()) {
      const ssize_t written =
          ::pwrite(descriptor_, rest.data(), rest.size(), static_cast<off_t>(end_ + lines.size() - rest.size()));
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) fail();
      rest.remove_prefix(static_cast<std::size_t>(written));
    }
    if (::fdatasync(descriptor_) != 0 && errno != EINVAL) fail();
    end_ += lines.size();
    next_ = next;
  }
  const fs::path& path() const { return path_; }

 private:
  // Leaves the file as it was before the entry.
  [[noreturn]] void fail() {
    const std::string reason = std::strerror(errno);
    [[maybe_unused]] const int ignored = ::ftruncate(descriptor_, static_cast<off_t>(end_));
    throw FileError(path_, "the journal cannot be written: " + reason);
  }

  fs::path path_;
  int descriptor_;
  std::uint64_t end_;
  std::uint64_t next_;
};

Journal::Journal(std::unique_ptr<File> file) : file_(std::move(file)) {}
Journal::~Journal() = default;
Journal::Journal(Journal&&) noexcept = default;
Journal& Journal::operator=(Journal&&) noexcept = default;

Journal Journal::create(const fs::path& path, json about, std::vector<json> entries) {
  Journal journal(std::make_unique<File>(path, O_CREAT | O_EXCL, 0, 0));
  about["rebake_journal"] = version;
  entries.insert(entries.begin(), std::move(about));
  journal.file_->append(std::move(entries));
  sync_folder_of(path);
  return journal;
}

Journal Journal::reopen(const fs::path& path, const Contents& contents) {
  return Journal(std::make_unique<File>(path, 0, contents.good_bytes, contents.entries.size() + 1));
}

void Journal::append(json entry) { file_->append({std::move(entry)}); }
const fs::path& Journal::path() const { return file_->path(); }

void Journal::discard() {
  std::error_code ignored;
  fs::remove(file_->path(), ignored);
}

Journal::Contents Journal::read(const fs::path& path) {
  const std::string bytes = read_file(path);
  Contents contents;
  std::size_t number = 0;
  for (std::size_t begin = 0; begin < bytes.size();) {
    const std::size_t end = bytes.find('\n', begin);
    const std::string_view line = std::string_view(bytes).substr(begin, end - begin);
    const bool last = end == std::string::npos || end + 1 == bytes.size();
    const bool whole = end != std::string::npos && line.size() > digits + 1 &&
                       fmt::format("{:016x}", content_hash(line.substr(digits + 1))) == line.substr(0, digits);
    json entry = whole ? json::parse(line.substr(digits + 1), nullptr, false) : json();
    if (number == 0) {
      if (!whole && (bytes.size() < 200 && last)) {
        // Killed while beginning: nothing was done yet.
        contents.torn = true;
        return contents;
      }
      if (!whole || !entry.is_object() || !entry.contains("rebake_journal"))
        throw FileError(path, "is not a journal of Rebake");
      if (entry.at("rebake_journal") != version)
        throw FileError(path, "was written by a newer version of Rebake; open it with that one");
      contents.about = std::move(entry);
    } else if (!whole) {
      if (!last)
        throw FileError(path,
                        fmt::format("line {} is damaged; the {} edits before it are whole: cut the file off there "
                                    "to get them back",
                                    number + 1, number - 1));
      contents.torn = true;
      return contents;
    } else if (!entry.is_object() || entry.value("n", json()) != number) {
      throw FileError(path, fmt::format("line {} does not follow the one before", number + 1));
    } else {
      contents.entries.push_back(std::move(entry));
    }
    begin = end + 1;
    contents.good_bytes = begin;
    ++number;
  }
  if (number == 0) contents.torn = true;
  return contents;
}

}  // namespace rebake
