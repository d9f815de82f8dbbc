#include "editor/film/picture_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <nlohmann/json.hpp>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/formats/rebake_scene/scene_folder.h"
#include "mesh_ops/texture/texels.h"
#include "render/image.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

constexpr const char* record = "film.json";
constexpr const char* mark = "rebake_film";

template <class Value>
void add(ContentHash& hash, const std::vector<Value>& values) {
  hash.add({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value)});
}
void add(ContentHash& hash, const Affine& affine) {
  hash.add({reinterpret_cast<const char*>(affine.data()), 16 * sizeof(double)});
}

std::uint64_t object_hash(const BakedObject& object) {
  ContentHash hash;
  for (const TextureSet& set : object.sets) {
    add(hash, set.soup.positions());
    add(hash, set.soup.uvs());
    add(hash, set.soup.faces());
    if (set.soup.rotations()) add(hash, *set.soup.rotations());
    for (int row = 0; row < set.texels->tile_rows(); ++row)
      for (int column = 0; column < set.texels->tile_columns(); ++column)
        add(hash, *set.texels->tile(column, row)->texels());
  }
  const Decoder& decoder = *object.decoder;
  for (const auto* matrix : {&decoder.weights0, &decoder.weights1, &decoder.weights2})
    hash.add({reinterpret_cast<const char*>(matrix->data()), static_cast<std::size_t>(matrix->size()) * sizeof(float)});
  for (const auto* bias : {&decoder.bias0, &decoder.bias1, &decoder.bias2})
    hash.add({reinterpret_cast<const char*>(bias->data()), static_cast<std::size_t>(bias->size()) * sizeof(float)});
  return hash.value();
}

bool is_numbered(const std::string& name) {
  const std::size_t dot = name.find('.');
  return dot >= 5 && dot != std::string::npos &&
         std::all_of(name.begin(), name.begin() + static_cast<std::ptrdiff_t>(dot),
                     [](unsigned char c) { return std::isdigit(c) != 0; });
}

}  // namespace

std::uint64_t picture_hash(const Scene& scene, const Progress& progress) {
  ContentHash hash;
  std::map<const BakedObject*, std::string> known;
  const std::vector<PlacedNode> nodes = placed_nodes(scene);
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    progress.at("checking the scene", static_cast<double>(k) / static_cast<double>(nodes.size()));
    const Node& node = *nodes[k].node;
    if (!node.object) continue;
    std::string& text = known[node.object.get()];
    if (text.empty()) text = hash_text(object_hash(*node.object));
    for (const auto& [name, flags] : node.saved_selections) {
      hash.add(name);
      add(hash, *flags);
    }
    if (node.motion)
      for (const auto& [name, track] : node.motion->bends) {
        add(hash, track.to_space);
        for (const auto& key : track.degrees)
          hash.add(fmt::format("{} {} {} {};", name, key.seconds, key.value, static_cast<int>(key.to_next)));
      }
    for (const BakedBody& body : node.object->bodies) {
      std::string& body_text = known[body.object.get()];
      if (body_text.empty()) body_text = hash_text(object_hash(*body.object));
    }
  }
  hash.add(write_scene_json(scene, known, scene.light != nullptr));
  return hash.value();
}

PictureFolder::PictureFolder(fs::path folder, std::string extension, const std::string& content,
                             const SourceGuard& sources)
    : folder_(std::move(folder)), extension_(std::move(extension)) {
  sources.check_folder(folder_);
  std::error_code error;
  std::vector<fs::path> pictures;
  bool same = false, any = false;
  if (fs::exists(folder_, error)) {
    if (!fs::is_directory(folder_)) throw FileError(folder_, "is a file; name a folder, or a .mp4 or .webm file");
    for (const auto& entry : fs::directory_iterator(folder_)) {
      any = true;
      const std::string name = entry.path().filename().string();
      if (name != record && !(is_numbered(name) && entry.is_regular_file() && !entry.is_symlink()))
        throw FileError(folder_,
                        fmt::format("contains \"{}\", which is not part of a film; choose another folder", name));
      if (name != record) pictures.push_back(entry.path());
    }
    if (any) {
      const auto before = fs::exists(folder_ / record)
                              ? nlohmann::json::parse(read_file(folder_ / record), nullptr, false)
                              : nlohmann::json();
      if (!before.is_object() || !before.contains(mark))
        throw FileError(folder_, "exists and is not a film's folder; choose a new or empty folder");
      same = before.value("content", "") == content;
    }
  }
  fs::create_directories(folder_, error);
  if (error) throw FileError(folder_, "cannot be created: " + error.message());
  if (same) return;
  for (const fs::path& picture : pictures) {
    sources.check_file(picture);
    remove_file(picture);
  }
  removed_ = pictures.size();
  write_file_atomically(folder_ / record, nlohmann::json{{mark, 1}, {"content", content}}.dump(1) + "\n", sources);
}

fs::path PictureFolder::picture(std::size_t number) const {
  return folder_ / fmt::format("{:05}{}", number, extension_);
}

fs::path PictureFolder::pattern() const { return folder_ / ("%05d" + extension_); }

bool PictureFolder::has(std::size_t number) const { return is_picture_file(picture(number)); }

}  // namespace rebake
