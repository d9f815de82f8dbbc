#include "mesh_ops/formats/cameras/photo_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

namespace rebake {

namespace {

// The text with U+FFFD in place of bytes that are not UTF-8.
std::string valid_utf8(const std::string& text) {
  const nlohmann::json value = text;
  return nlohmann::json::parse(value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

std::string name_of(const PhotoCamera& camera, std::size_t number, bool with_folders) {
  const std::filesystem::path path(camera.name);
  const std::string stem = path.stem().string();
  if (stem.find_first_not_of('.') == std::string::npos) return fmt::format("camera {}", number);
  std::string name = with_folders ? (path.parent_path() / stem).generic_string() : stem;
  // The names are also file names.
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return c == '/' || c < ' '; }, '-');
  return valid_utf8(name);
}

}  // namespace

std::vector<std::string> photo_names(const std::vector<PhotoCamera>& cameras) {
  std::set<std::string> stems;
  for (std::size_t k = 0; k < cameras.size(); ++k) stems.insert(name_of(cameras[k], k, false));
  const bool with_folders = stems.size() < cameras.size();
  std::vector<std::string> names;
  std::set<std::string> used;
  for (std::size_t k = 0; k < cameras.size(); ++k) {
    const std::string first = name_of(cameras[k], k, with_folders);
    std::string name = first;
    for (int copy = 2; !used.insert(name).second; ++copy) name = fmt::format("{} {}", first, copy);
    names.push_back(std::move(name));
  }
  return names;
}

}  // namespace rebake
