#include "editor/batch/batch_claims.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/base/hash.h"

namespace rebake {

namespace fs = std::filesystem;

BatchClaims::BatchClaims(fs::path folder) : folder_(std::move(folder)) { fs::create_directories(folder_); }

std::string BatchClaims::claim(const std::string& output, const std::string& scene) const {
  const fs::path path = path_of(output);
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (file >= 0) {
    const bool whole = ::write(file, scene.data(), scene.size()) == static_cast<ssize_t>(scene.size());
    ::close(file);
    if (!whole) throw FileError(path, "cannot be written");
    return "";
  }
  if (errno != EEXIST) throw FileError(path, "cannot be created");
  const std::string other = read_file(path);
  return other == scene ? "" : other.empty() ? "another scene" : other;
}

void BatchClaims::release(const std::string& output, const std::string& scene) const {
  const fs::path path = path_of(output);
  if (fs::exists(path) && read_file(path) == scene) fs::remove(path);
}

fs::path BatchClaims::path_of(const std::string& output) const { return folder_ / hash_text(content_hash(output)); }

}  // namespace rebake
