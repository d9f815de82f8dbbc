#include "editor/actions/output_state.h"

#include <utility>

#include "mesh_ops/formats/formats.h"
#include "mesh_ops/formats/scene_files.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

std::optional<std::uint64_t> content_at(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error) || (fs::is_directory(path, error) && fs::is_empty(path, error))) return std::nullopt;
  // Exports refuse folders that are no scenes. Such a folder may hold very much.
  if (fs::is_directory(path, error) && format_at(path) == nullptr) return 0;
  return output_hash_at(path);
}

}  // namespace

OutputState::OutputState(fs::path path) : path_(std::move(path)), content_(content_at(path_)) {}

bool OutputState::has_content() const { return content_at(path_).has_value(); }

bool OutputState::has_other_content() const {
  const std::optional<std::uint64_t> now = content_at(path_);
  return now && now != content_;
}

}  // namespace rebake
