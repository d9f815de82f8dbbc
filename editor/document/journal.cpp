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
  std::string text;
  try {
    text = entry.dump();
  } catch (const json::type_error&) {
    throw Error("the journal holds text only: a name or path has bytes that are not UTF-8");
  }
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

namespace {

struct Parsed {
  Journal::Contents contents;
  std::uint64_t good_bytes = 0;  // where the last whole line ends
};

// The first line as create() begins it; a file that holds a piece of it only was being begun.
std::string first_line() { return line_of({{"rebake_journal", version}}); }

Parsed parse(const fs::path& path, std::string_view bytes) {
  Parsed parsed;
  std::size_t number = 0;
  for (std::size_t begin = 0; begin < bytes.size();) {
    const std::size_t end = bytes.find('\n', begin);
    const std::string_view line = bytes.substr(begin, end == std::string_view::npos ? end : end - begin);
    const bool last = end == std::string_view::npos || end + 1 == bytes.size();
    const bool whole = end != std::string_view::npos && line.size() > digits + 1 &&
                       fmt::format("{:016x}", content_hash(line.substr(digits + 1))) == line.substr(0, digits);
    json entry = whole ? json::parse(line.substr(digits + 1), nullptr, false) : json();
    if (number == 0) {
      if (!whole && first_line().starts_with(bytes)) {
        parsed.contents.torn = true;
        return parsed;
      }
      if (!whole || !entry.is_object() || !entry.contains("rebake_journal"))
        throw FileError(path, "is not a journal of Rebake");
      if (entry.at("rebake_journal") != version)
        throw FileError(path, "was written by a newer version of Rebake; open it with that one");
      parsed.contents.about = std::move(entry);
    } else if (!whole) {
      if (!last)
        throw FileError(path,
                        fmt::format("line {} is damaged; the {} lines of work before it are whole: cut the file off "
                                    "there to get them back",
                                    number + 1, number - 1));
      parsed.contents.torn = true;
      return parsed;
    } else if (!entry.is_object() || entry.value("n", json()) != number) {
      throw FileError(path, fmt::format("line {} does not follow the one before", number + 1));
    } else {
      parsed.contents.entries.push_back(std::move(entry));
    }
    begin = end + 1;
    parsed.good_bytes = begin;
    ++number;
  }
  return parsed;
}

}  // namespace

class Journal::File {
 public:
  // Opens and locks.
  File(fs::path path, int flags) : path_(std::move(path)), descriptor_{::open(path_.c_str(), flags | O_CLOEXEC, 0666)} {
    if (descriptor_.value < 0 && errno == EEXIST)
      throw FileError(path_, "is there already and may hold work: get it back with \"rebake recover\", or remove it");
    if (descriptor_.value < 0)
      throw FileError(path_, std::string("cannot be opened for writing: ") + std::strerror(errno));
    if (::flock(descriptor_.value, LOCK_EX | LOCK_NB) != 0)
      throw FileError(path_, "is being written by another Rebake");
  }

  Contents resume() {
    Parsed parsed = parse(path_, read_file(path_));
    end_ = parsed.good_bytes;
    next_ = parsed.contents.entries.size() + (end_ > 0 ? 1 : 0);
    if (::ftruncate(descriptor_.value, static_cast<off_t>(end_)) != 0) fail();
    if (end_ == 0) append({json{{"rebake_journal", version}}});
    return std::move(parsed.contents);
  }

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
          ::pwrite(descriptor_.value, rest.data(), rest.size(), static_cast<off_t>(end_ + lines.size() - rest.size()));
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) fail();
      rest.remove_prefix(static_cast<std::size_t>(written));
    }
    if (::fdatasync(descriptor_.value) != 0 && errno != EINVAL) fail();
    end_ += lines.size();
    next_ = next;
  }
  const fs::path& path() const { return path_; }

 private:
  // Leaves the file as it was before the entry.
  [[noreturn]] void fail() {
    const std::string reason = std::strerror(errno);
    [[maybe_unused]] const int ignored = ::ftruncate(descriptor_.value, static_cast<off_t>(end_));
    throw FileError(path_, "the journal cannot be written: " + reason);
  }

  struct Descriptor {
    int value;
    explicit Descriptor(int opened) : value(opened) {}
    ~Descriptor() {
      if (value >= 0) ::close(value);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
  };
  fs::path path_;
  Descriptor descriptor_;
  std::uint64_t end_ = 0;
  std::uint64_t next_ = 0;
};

Journal::Journal(std::unique_ptr<File> file) : file_(std::move(file)) {}
Journal::~Journal() = default;
Journal::Journal(Journal&&) noexcept = default;
Journal& Journal::operator=(Journal&&) noexcept = default;

Journal Journal::create(const fs::path& path, json about, std::vector<json> entries) {
  Journal journal(std::make_unique<File>(path, O_WRONLY | O_CREAT | O_EXCL));
  about["rebake_journal"] = version;
  entries.insert(entries.begin(), std::move(about));
  journal.file_->append(std::move(entries));
  sync_folder_of(path);
  return journal;
}

Journal Journal::resume(const fs::path& path, Contents& contents) {
  if (std::error_code error; !fs::is_regular_file(path, error)) throw FileError(path, "is not there, or is not a file");
  Journal journal(std::make_unique<File>(path, O_RDWR));
  contents = journal.file_->resume();
  return journal;
}

void Journal::append(json entry) { file_->append({std::move(entry)}); }
const fs::path& Journal::path() const { return file_->path(); }

void Journal::discard() {
  std::error_code ignored;
  fs::remove(file_->path(), ignored);
}

bool Journal::in_use(const fs::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return false;
  const bool free = ::flock(descriptor, LOCK_EX | LOCK_NB) == 0;
  ::close(descriptor);
  return !free;
}

Journal::Contents Journal::read(const fs::path& path) { return parse(path, read_file(path)).contents; }

}  // namespace rebake
