#include "editor/batch/batch_mark.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/formats/scene_files.h"

namespace rebake {

namespace fs = std::filesystem;

BatchMark mark_from(const std::string& text, const fs::path& out) {
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
    if (line.contains("wrote"))
      mark.wrote.push_back({fs::weakly_canonical(fs::absolute(out) / line.value("wrote", "")).string(),
                            line.value("content", ""), line.value("bytes", false)});
  }
  return mark;
}

BatchMark read_mark(const fs::path& path, const fs::path& out) {
  return fs::exists(path) ? mark_from(read_file(path), out) : BatchMark();
}

std::string with_relative_outputs(const std::string& mark, const fs::path& out) {
  std::string text;
  for (std::size_t begin = 0; begin < mark.size();) {
    const std::size_t end = std::min(mark.find('\n', begin), mark.size());
    const std::string line = mark.substr(begin, end - begin);
    begin = end + 1;
    nlohmann::json object = nlohmann::json::parse(line, nullptr, false);
    if (object.is_object() && object.contains("wrote")) {
      const fs::path relative =
          fs::weakly_canonical(object.value("wrote", "")).lexically_relative(fs::weakly_canonical(out));
      if (!relative.empty() && *relative.begin() != "..") {
        object["wrote"] = relative.string();
        text += object.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + '\n';
        continue;
      }
    }
    text += line + '\n';
  }
  return text;
}

std::vector<BatchMark::File> latest_outputs(const BatchMark& earlier, const BatchMark& later) {
  std::vector<BatchMark::File> outputs = later.wrote;
  for (const BatchMark::File& file : earlier.wrote)
    if (std::none_of(later.wrote.begin(), later.wrote.end(),
                     [&](const BatchMark::File& newer) { return newer.path == file.path; }))
      outputs.push_back(file);
  return outputs;
}

namespace {

bool has_content(const BatchMark::File& file, std::uint64_t (*hash_at)(const fs::path&)) {
  try {
    return hash_text(hash_at(file.path)) == file.content;
  } catch (const FileError&) {
    return false;
  }
}

}  // namespace

bool is_unchanged_output(const BatchMark::File& file) {
  return has_content(file, file.bytes ? output_hash_at : content_hash_at);
}

bool is_up_to_date(const BatchMark& mark, const std::string& key) {
  return mark.key == key &&
         std::all_of(mark.read.begin(), mark.read.end(),
                     [](const auto& file) { return has_content(file, content_hash_at); }) &&
         std::all_of(mark.wrote.begin(), mark.wrote.end(), is_unchanged_output);
}

std::string edited_output(const std::vector<BatchMark::File>& outputs) {
  const auto edited = std::find_if(outputs.begin(), outputs.end(), [](const BatchMark::File& file) {
    std::error_code error;
    return fs::exists(file.path, error) && !is_unchanged_output(file);
  });
  return edited == outputs.end() ? "" : edited->path;
}

std::string list_of(const std::vector<BatchMark::File>& outputs) {
  std::string text;
  for (const BatchMark::File& output : outputs)
    text += nlohmann::json{{"wrote", output.path}, {"content", output.content}, {"bytes", output.bytes}}.dump(
                -1, ' ', false, nlohmann::json::error_handler_t::replace) +
            '\n';
  return text;
}

}  // namespace rebake
