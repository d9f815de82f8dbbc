#include "editor/film/picture_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/formats/cameras/keyframes_json.h"
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
std::uint64_t object_hash(const BakedObject& object) {
  ContentHash hash;
  for (const TextureSet& set : object.sets) {
    add(hash, set.soup.positions());
    add(hash, set.soup.uvs());
    add(hash, set.soup.faces());
    hash.add(set.texels->alpha_code() == AlphaCode::halved ? "halved" : "plain");
    if (set.soup.rotations()) add(hash, *set.soup.rotations());
    for (int row = 0; row < set.texels->tile_rows(); ++row)
      for (int column = 0; column < set.texels->tile_columns(); ++column)
        add(hash, *set.texels->tile(column, row)->texels());
  }
  const Decoder& decoder = *object.decoder;
  hash.add(std::to_string(static_cast<int>(decoder.rule)));
  for (const auto* matrix : {&decoder.weights0, &decoder.weights1, &decoder.weights2})
    hash.add(
        {reinterpret_cast<const char*>(matrix->data()), static_cast<std::size_t>(matrix->size()) * sizeof(double)});
  for (const auto* bias : {&decoder.bias0, &decoder.bias1, &decoder.bias2})
    hash.add({reinterpret_cast<const char*>(bias->data()), static_cast<std::size_t>(bias->size()) * sizeof(double)});
  return hash.value();
}

std::string picture_name(std::size_t number, const std::string& extension) {
  return fmt::format("{:05}{}", number, extension);
}

// The record of a film's folder; null if there is none.
nlohmann::json record_in(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_regular_file(folder / record, error)) return {};
  const auto read = nlohmann::json::parse(read_file(folder / record), nullptr, false);
  return read.is_object() && read.contains(mark) ? read : nlohmann::json();
}

// Whether a name is that of a picture, or of the record, whose writing was killed.
bool is_leftover(const std::string& name, const std::set<std::string>& pictures) {
  return is_partial_of(name, record) || std::any_of(pictures.begin(), pictures.end(), [&](const std::string& picture) {
           return is_partial_of(name, picture);
         });
}

// The pictures of the film that a folder holds; removes leftovers of killed runs. Throws FileError if it holds anything
// else, and removes nothing then.
std::vector<fs::path> film_pictures(const fs::path& folder, const nlohmann::json& known) {
  std::set<std::string> names;
  if (known.is_object())
    for (std::size_t k = 0; k < known.value("count", std::size_t{0}); ++k)
      names.insert(picture_name(k, known.value("extension", "")));
  std::vector<fs::path> pictures, leftovers;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (known.is_object() && name == record) continue;
    if (is_leftover(name, names)) {
      leftovers.push_back(entry.path());
      continue;
    }
    if (!names.contains(name) || !entry.is_regular_file() || entry.is_symlink())
      throw FileError(folder,
                      known.is_object()
                          ? fmt::format("contains \"{}\", which is not part of its film; choose another folder", name)
                          : "exists and is not a film's folder; choose a new or empty folder");
    pictures.push_back(entry.path());
  }
  for (const fs::path& leftover : leftovers) remove_file(leftover);
  return pictures;
}

// Someone may have put a picture of their own under such a name, or retouched one.
void refuse_changed(const std::vector<fs::path>& pictures) {
  for (const fs::path& picture : pictures)
    if (std::error_code error; fs::file_size(picture, error) > 0 && !is_rendered_picture(picture))
      throw FileError(picture,
                      "was not rendered by Rebake, was changed or damaged since, or is of an earlier build; move the "
                      "folder's pictures elsewhere, or choose another folder");
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
        // With its selection, which scene.json leaves out.
        NodeMotion one;
        one.bends[name] = track;
        one.bends[name].selection.clear();
        hash.add(track.selection + motion_json(one).dump());
      }
    for (const BakedBody& body : node.object->bodies) {
      std::string& body_text = known[body.object.get()];
      if (body_text.empty()) body_text = hash_text(object_hash(*body.object));
    }
  }
  hash.add(write_scene_json(scene, known, scene.light != nullptr));
  return hash.value();
}

PictureFolder::PictureFolder(fs::path folder, std::string extension, std::size_t count, const std::string& content,
                             bool replaces, const SourceGuard& sources)
    : folder_(std::move(folder)), extension_(std::move(extension)) {
  sources.check_folder(folder_);
  std::error_code error;
  if (fs::exists(folder_, error)) {
    if (!fs::is_directory(folder_)) throw FileError(folder_, "is a file; name a folder, or a .mp4 or .webm file");
    if (replaces && fs::is_symlink(folder_, error))
      throw FileError(folder_, "is a link; remove it, or choose another name for the video");
    if (fs::is_symlink(folder_ / record, error))
      throw FileError(folder_ / record, "is a link; choose another folder for the film");
    lock();
    const nlohmann::json before = record_in(folder_);
    const std::vector<fs::path> pictures = film_pictures(folder_, before);
    refuse_changed(pictures);
    const bool of_video = before.is_object() && before.value("video", false);
    if (before.is_object() && before.value("content", "") == content) {
      if (replaces && !of_video)
        throw FileError(folder_,
                        "holds the pictures of this film because they were asked for, and would be removed after the "
                        "video is made; choose another name for the video");
      // From now on the pictures are wanted themselves.
      if (!replaces && of_video) write_record(count, content, false, sources);
      return;
    }
    if (!pictures.empty() && (!replaces || !of_video))
      throw FileError(folder_,
                      "holds pictures of another film: the scene, the way or the options differ; choose another "
                      "folder, or remove this one first");
    for (const fs::path& picture : pictures) {
      sources.check_file(picture);
      remove_file(picture);
    }
    removed_ = pictures.size();
  }
  fs::create_directories(folder_, error);
  if (error) throw FileError(folder_, "cannot be created: " + error.message());
  if (!lock_) lock();
  write_record(count, content, replaces, sources);
}

void PictureFolder::write_record(std::size_t count, const std::string& content, bool of_video,
                                 const SourceGuard& sources) const {
  write_file_atomically(
      folder_ / record,
      nlohmann::json{{mark, 1}, {"content", content}, {"count", count}, {"extension", extension_}, {"video", of_video}}
              .dump(1) +
          "\n",
      sources);
}

void PictureFolder::lock() {
  lock_.emplace(folder_, FolderLock::Wait::no);
  if (!lock_->held()) throw FileError(folder_, "is in use: another run writes its film there");
}

void PictureFolder::remove() const {
  const std::vector<fs::path> pictures = film_pictures(folder_, record_in(folder_));
  refuse_changed(pictures);
  for (const fs::path& picture : pictures) remove_file(picture);
  remove_file(folder_ / record);
  std::error_code error;
  fs::remove(folder_, error);
}

fs::path PictureFolder::picture(std::size_t number) const { return folder_ / picture_name(number, extension_); }

fs::path PictureFolder::pattern() const {
  std::string pattern;
  for (const char c : folder_.string()) pattern += c == '%' ? "%%" : std::string(1, c);
  return fs::path(pattern) / ("%05d" + extension_);
}

void PictureFolder::refuse_foreign(std::size_t number) const {
  const fs::path file = picture(number);
  std::error_code error;
  if (!fs::exists(fs::symlink_status(file, error))) return;
  if (fs::is_symlink(file, error)) throw FileError(file, "is a link; choose another folder for the film");
  refuse_changed({file});
}

bool PictureFolder::has(std::size_t number) const {
  std::error_code error;
  if (!fs::exists(picture(number), error)) return false;
  try {
    read_image(picture(number));
    return true;
  } catch (const FileError&) {
    return false;  // empty: it is rendered again
  }
}

}  // namespace rebake
