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
  const fs::path folder = plain_path(file ? fs::absolute(source).parent_path() : source);
  if (std::find(folders_.begin(), folders_.end(), folder) == folders_.end()) folders_.push_back(folder);
}

void SourceGuard::check_file(const fs::path& path) const {
  const fs::path wanted = plain_path(path);
  for (const fs::path& folder : folders_)
    if (lies_in(wanted, folder))
      throw FileError(path, "would be written into the source \"" + folder.string() +
                                "\", which undo, journals and projects read again; choose another place");
}

void SourceGuard::check_folder(const fs::path& path) const {
  const fs::path wanted = plain_path(path);
  for (const fs::path& folder : folders_) {
    if (wanted == folder)
      throw FileError(path,
                      "is a source of what is open, which undo, journals and projects read again; write to another "
                      "folder");
    if (lies_in(folder, wanted))
      throw FileError(
          path, "holds the source \"" + folder.string() + "\", which would be lost with it; write to another folder");
  }
  check_file(path);
}

}  // namespace rebake
