#include "mesh_ops/base/source_guard.h"

#include <algorithm>

#include "mesh_ops/base/error.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

// Without links, dots and a slash at the end; what is not there yet by its name.
fs::path plain_path(const fs::path& path) {
  std::error_code error;
  fs::path result = fs::weakly_canonical(fs::absolute(path), error);
  if (error) result = fs::absolute(path).lexically_normal();
  return result.has_filename() ? result : result.parent_path();
}

bool lies_in(const fs::path& path, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
}

}  // namespace

void SourceGuard::add(const fs::path& source) {
  std::error_code error;
  const bool file = fs::is_regular_file(source, error) || source.filename() == "scene.json";
  add_path(plain_path(file ? fs::absolute(source).parent_path() : source));
}

void SourceGuard::add_file(const fs::path& source) { add_path(plain_path(source)); }

void SourceGuard::add_path(fs::path path) {
  if (std::find(sources_.begin(), sources_.end(), path) == sources_.end()) sources_.push_back(std::move(path));
}

void SourceGuard::check_file(const fs::path& path) const {
  const fs::path wanted = plain_path(path);
  for (const fs::path& source : sources_)
    if (lies_in(wanted, source))
      throw FileError(path, "would be written into the source \"" + source.string() +
                                "\", which undo, journals and projects read again; choose another place");
}

void SourceGuard::check_folder(const fs::path& path) const {
  const fs::path wanted = plain_path(path);
  for (const fs::path& source : sources_) {
    if (wanted == source)
      throw FileError(path,
                      "is a source of what is open, which undo, journals and projects read again; write to another "
                      "folder");
    if (lies_in(source, wanted))
      throw FileError(
          path, "holds the source \"" + source.string() + "\", which would be lost with it; write to another folder");
  }
  check_file(path);
}

}  // namespace rebake
