#include "editor/batch/batch_mark.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/formats/scene_files.h"

namespace rebake {

namespace fs = std::filesystem;

BatchMark mark_from(const std::string& text) {
  BatchMark mark;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const nlohmann::json line = nlohmann::json::parse(text.begin() + static_cast<std::ptrdiff_t>(begin),
                                                      text.begin() + static_cast<std::ptrdiff_t>(end), nullptr, false);
    begin = end + 1;
    if (!line.is_object()) continue;
    mark.key = line.value("key", mark.key);
    mark.below_requested_psnr = line.value("below_asked", mark.below_requested_psnr);
    if (line.contains("read")) mark.read.push_back({line.value("read", ""), line.value("content", "")});
    if (line.contains("wrote")) mark.wrote.push_back({line.value("wrote", ""), line.value("content", "")});
  }
  return mark;
}

BatchMark read_mark(const fs::path& path) { return fs::exists(path) ? mark_from(read_file(path)) : BatchMark(); }

bool is_unchanged(const BatchMark::File& file) {
  try {
    return hash_text(content_hash_at(file.path)) == file.content;
  } catch (const FileError&) {
    return false;
  }
}

bool is_up_to_date(const BatchMark& mark, const std::string& key) {
  return mark.key == key && std::all_of(mark.read.begin(), mark.read.end(), is_unchanged) &&
         std::all_of(mark.wrote.begin(), mark.wrote.end(), is_unchanged);
}

std::string edited_output(const BatchMark& mark) {
  const auto edited = std::find_if(mark.wrote.begin(), mark.wrote.end(), [](const BatchMark::File& file) {
    std::error_code error;
    return fs::exists(file.path, error) && !is_unchanged(file);
  });
  return edited == mark.wrote.end() ? "" : edited->path;
}

std::string list_without_key(const std::string& mark) {
  const std::size_t first = mark.find('\n');
  return mark.starts_with("{\"below_asked\"") && first != std::string::npos ? mark.substr(first + 1) : mark;
}

}  // namespace rebake
