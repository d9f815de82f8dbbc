#include "editor/document/journal.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/file_calls.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/base/hash.h"

namespace rebake {

using nlohmann::json;
namespace fs = std::filesystem;

namespace {

constexpr int journal_version = 3;
constexpr std::size_t checksum_digits = 16;

std::string line_of(const json& entry) {
  std::string text;
  try {
    text = entry.dump();
  } catch (const json::type_error&) {
    throw Error("the journal cannot be written: a name or path is not valid UTF-8");
  }
  return fmt::format("{} {}\n", hash_text(content_hash(text)), text);
}

struct Parsed {
  Journal::Contents contents;
  std::uint64_t good_bytes = 0;  // end of the last intact line before any damage
  bool ends_in_newline = true;   // whether that line ends in a newline
  bool begun = false;            // the first line is intact
};

std::string first_line(int of) { return line_of({{"rebake_journal", of}}); }

// The JSON of a line; nothing if its checksum is wrong.
std::optional<json> whole(std::string_view line) {
  if (line.size() <= checksum_digits + 1 || line[checksum_digits] != ' ' ||
      hash_text(content_hash(line.substr(checksum_digits + 1))) != line.substr(0, checksum_digits))
    return std::nullopt;
  json entry = json::parse(line.substr(checksum_digits + 1), nullptr, false);
  return entry.is_object() ? std::optional(std::move(entry)) : std::nullopt;
}

Parsed parse(const fs::path& path, std::string_view bytes) {
  Parsed parsed;
  Journal::Contents& contents = parsed.contents;
  // A truncated first line: the program ended while it began the journal.
  for (int of = 1; of <= journal_version; ++of)
    if (bytes.size() < first_line(of).size() && first_line(of).starts_with(bytes)) {
      contents.torn = true;
      return parsed;
    }
  std::size_t number = 0, whole_lines = 0;
  for (std::size_t begin = 0; begin < bytes.size(); ++number) {
    const std::size_t end = bytes.find('\n', begin);
    const bool ends = end != std::string_view::npos;
    const std::string_view line = bytes.substr(begin, ends ? end - begin : end);
    std::optional<json> entry = whole(line);
    begin = ends ? end + 1 : bytes.size();
    // Damage of the newline itself: the entry before it is intact.
    const bool newline_damaged = !entry && !ends && (entry = whole(line.substr(0, line.size() - 1)));
    if (newline_damaged) --begin;
    if (number == 0 && entry && entry->contains("rebake_journal")) {
      const json& of = entry->at("rebake_journal");
      if (!of.is_number_unsigned() || of.get<std::uint64_t>() > journal_version)
        throw FileError(path, "was written by a newer version of Rebake; open it with that version");
      contents.current = of.get<std::uint64_t>() == journal_version;
      parsed.begun = true;
      parsed.good_bytes = begin;
      continue;
    }
    // Damage may have joined or split lines, so behind it entry numbers need not match line numbers.
    const bool follows =
        entry && (contents.damaged_line != 0 ? entry->contains("n") : entry->value("n", json()) == number);
    whole_lines += follows ? 1 : 0;
    const std::string text = follows ? entry->dump() : "";
    if (contents.damaged_line != 0) {
      if (follows) contents.after.push_back({number + 1, text});
    } else if (follows && number > 0) {
      contents.entries.push_back(text);
      parsed.good_bytes = begin;
      parsed.ends_in_newline = ends;
      if (newline_damaged) break;
    } else if (number > 0 && !ends && line.find('\0') == std::string_view::npos) {
      contents.torn = true;  // the program ended while it wrote this last line
    } else if (number > 0) {
      contents.damaged_line = number + 1;
    }
  }
  if (!parsed.begun) {
    // If other lines are intact, only the first is damaged; it contains nothing but the version.
    if (whole_lines == 0) throw FileError(path, "is not a Rebake journal");
    if (contents.damaged_line == 0) contents.damaged_line = 1;
  }
  return parsed;
}

}  // namespace

class Journal::File {
 public:
  // Opens the file and locks it for this process. Throws FileError if another process holds the lock.
  File(fs::path path, int flags) : path_(std::move(path)), descriptor_(open(path_, flags)) {
    if (::flock(descriptor_.value, LOCK_EX | LOCK_NB) != 0)
      throw FileError(path_, "is in use by another Rebake process");
  }

  Contents resume() {
    const std::string bytes = read_file(path_);
    Parsed parsed = parse(path_, bytes);
    end_ = parsed.good_bytes;
    next_ = parsed.contents.entries.size() + (parsed.begun ? 1 : 0);
    damaged_ = parsed.contents.damaged_line != 0;
    const bool whole = end_ == bytes.size() && parsed.begun && parsed.ends_in_newline;
    if (!whole) torn_ = Torn{bytes.size(), parsed.begun, parsed.ends_in_newline};
    return std::move(parsed.contents);
  }

  void append(const std::vector<json>& entries) {
    if (damaged_) throw FileError(path_, "is damaged, so no edit can be added; recover it with rebake recover");
    if (!is_in_place() || size() != (torn_ ? torn_->bytes : end_))
      throw FileError(
          path_, "was removed, replaced or changed by another program, so it no longer protects this work; save now");
    leave_other_names();
    mend();
    std::string lines;
    std::uint64_t next = next_;
    for (json entry : entries) {
      if (next > 0) entry["n"] = next;
      lines += line_of(entry);
      ++next;
    }
    append_text(lines);
    next_ = next;
  }
  const fs::path& path() const { return path_; }

  void discard() {
    if (is_in_place()) remove_file(path_);
  }

 private:
  // The end of a file whose last line is incomplete.
  struct Torn {
    std::uint64_t bytes;  // size of the file
    bool begun;           // has its first line
    bool ends_in_newline;
  };

  // Another hard link of the file is a copy, as of a backup, and keeps its content.
  void leave_other_names() {
    struct stat about {};
    if (::fstat(descriptor_.value, &about) != 0 || about.st_nlink < 2) return;
    write_file_atomically(path_, read_file(path_), {});
    Descriptor own(open(path_, O_RDWR));
    // Another editor that looks for lost work holds the lock for a moment.
    for (int attempt = 0; ::flock(own.value, LOCK_EX | LOCK_NB) != 0; ++attempt) {
      if (attempt == 100) throw FileError(path_, "is in use by another Rebake process");
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    std::swap(own.value, descriptor_.value);
  }

  // Removes an incomplete last line before the first append; a journal that is only read stays as it is.
  void mend() {
    if (!torn_) return;
    Torn torn = *torn_;
    torn_.reset();
    try {
      if (file_calls().ftruncate(descriptor_.value, static_cast<off_t>(end_)) != 0) fail();
      if (!torn.begun) append({json{{"rebake_journal", journal_version}}});
      torn.begun = true;
      if (!torn.ends_in_newline) append_text("\n");
    } catch (...) {
      torn.bytes = size();
      torn_ = torn;  // the next append tries again
      throw;
    }
  }

  // Writes at the end and syncs.
  void append_text(std::string_view text) {
    std::string_view rest = text;
    while (!rest.empty()) {
      const ssize_t written = file_calls().pwrite(descriptor_.value, rest.data(), rest.size(),
                                                  static_cast<off_t>(end_ + text.size() - rest.size()));
      if (written < 0 && errno == EINTR) continue;
      if (written == 0) errno = ENOSPC;
      if (written <= 0) fail();
      rest.remove_prefix(static_cast<std::size_t>(written));
    }
    if (file_calls().fsync(descriptor_.value) != 0 && errno != EINVAL) fail();
    end_ += text.size();
  }

  // Whether the path still leads to the open file.
  bool is_in_place() const {
    struct stat written {
    }, named{};
    return ::fstat(descriptor_.value, &written) == 0 && file_calls().stat(path_.c_str(), &named) == 0 &&
           written.st_dev == named.st_dev && written.st_ino == named.st_ino;
  }

  std::uint64_t size() const {
    struct stat about {};
    return ::fstat(descriptor_.value, &about) == 0 ? static_cast<std::uint64_t>(about.st_size) : 0;
  }

  static int open(const fs::path& path, int flags) {
    const int descriptor = file_calls().open(path.c_str(), flags | O_CLOEXEC, 0666);
    if (descriptor < 0 && errno == EEXIST)
      throw FileError(path,
                      "already exists and may contain unsaved work: recover it with \"rebake recover\", or remove it");
    if (descriptor < 0) throw FileError(path, std::string("cannot be opened for writing: ") + std::strerror(errno));
    return descriptor;
  }

  // Truncates the file to its size before the failed write, and throws FileError.
  [[noreturn]] void fail() {
    const std::string reason = std::strerror(errno);
    [[maybe_unused]] const int ignored = file_calls().ftruncate(descriptor_.value, static_cast<off_t>(end_));
    throw FileError(path_, "the journal cannot be written: " + reason);
  }

  struct Descriptor {
    int value;
    explicit Descriptor(int opened) : value(opened) {}
    ~Descriptor() { file_calls().close(value); }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
  };
  fs::path path_;
  Descriptor descriptor_;
  std::uint64_t end_ = 0;
  std::uint64_t next_ = 0;
  bool damaged_ = false;
  std::optional<Torn> torn_;
};

Journal::Journal(std::unique_ptr<File> file) : file_(std::move(file)) {}
Journal::~Journal() = default;
Journal::Journal(Journal&&) noexcept = default;
Journal& Journal::operator=(Journal&&) noexcept = default;

Journal Journal::create(const fs::path& path, const std::vector<json>& entries) {
  Journal journal(std::make_unique<File>(path, O_WRONLY | O_CREAT | O_EXCL));
  std::vector<json> lines{json{{"rebake_journal", journal_version}}};
  lines.insert(lines.end(), entries.begin(), entries.end());
  try {
    journal.file_->append(lines);
    sync_folder(path.parent_path());
  } catch (...) {
    std::error_code ignored;
    fs::remove(path, ignored);
    throw;
  }
  return journal;
}

namespace {

// Whether the system refuses to write a file, as on read-only media.
bool is_write_protected(const fs::path& path) {
  const int descriptor = file_calls().open(path.c_str(), O_RDWR | O_CLOEXEC, 0);
  if (descriptor < 0) return errno == EROFS || errno == EACCES || errno == EPERM;
  file_calls().close(descriptor);
  return false;
}

}  // namespace

std::optional<Journal> Journal::resume(const fs::path& path, Contents& contents) {
  if (std::error_code error; !fs::is_regular_file(path, error))
    throw FileError(path, "does not exist, or is not a file");
  if (is_write_protected(path)) {
    if (in_use(path)) throw FileError(path, "is in use by another Rebake process");
    contents = read(path);
    return std::nullopt;
  }
  Journal journal(std::make_unique<File>(path, O_RDWR));
  contents = journal.file_->resume();
  return journal;
}

void Journal::append(const json& entry) { file_->append({entry}); }
const fs::path& Journal::path() const { return file_->path(); }
void Journal::discard() { file_->discard(); }

bool Journal::is_journal(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return false;
  std::ifstream file(path, std::ios::binary);
  std::string begin(256, '\0');
  file.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  begin.resize(static_cast<std::size_t>(file.gcount()));
  const std::string first = begin.substr(0, begin.find('\n'));
  return first.find("\"rebake_journal\"") != std::string::npos;
}

void Journal::refuse_overwriting(const fs::path& path) {
  if (is_journal(path))
    throw FileError(
        path, "is a journal that may contain unsaved work: recover it with \"rebake recover\", or name another file");
}

bool Journal::in_use(const fs::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return false;
  const bool free = ::flock(descriptor, LOCK_EX | LOCK_NB) == 0;
  ::close(descriptor);
  return !free;
}

Journal::Contents Journal::read(const fs::path& path) { return parse(path, read_file(path)).contents; }

ActiveSteps steps_done(const Journal::Contents& contents) {
  struct Step {
    std::size_t line, end;  // index into entries; number of edits after the step
  };
  std::vector<Step> steps;
  std::size_t done = 0;
  const auto count_in = [](const json& value) { return value.is_number_unsigned() ? value.get<std::size_t>() : 1; };
  for (std::size_t line = 0; line < contents.entries.size(); ++line) {
    const json entry = json::parse(contents.entries[line]);
    if (entry.contains("undo")) {
      done -= std::min(done, count_in(entry.at("undo")));
    } else if (entry.contains("redo")) {
      done = std::min(steps.empty() ? 0 : steps.back().end, done + count_in(entry.at("redo")));
    } else {
      const json& step = entry.contains("adjust") ? entry.at("adjust") : entry;
      if (entry.contains("adjust")) done -= std::min(done, count_in(step.at("undo")));
      while (!steps.empty() && steps.back().end > done) steps.pop_back();
      done += step.contains("edits") ? step.at("edits").size() : 1;
      steps.push_back({line, done});
    }
  }
  ActiveSteps result;
  std::size_t end = 0;
  for (const Step& step : steps) {
    if (step.end > done) break;
    result.lines.push_back(step.line);
    end = step.end;
  }
  result.partial = end != done;
  result.undone = steps.empty() ? 0 : steps.back().end - std::min(steps.back().end, done);
  return result;
}

}  // namespace rebake
