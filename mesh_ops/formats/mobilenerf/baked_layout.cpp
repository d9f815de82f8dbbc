#include "mesh_ops/formats/mobilenerf/baked_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "mesh_ops/formats/mobilenerf/folder_names.h"

namespace rebake {

namespace {

// Number of files after a missing one that are looked for.
constexpr std::size_t gap = 64;

class LayoutFinder {
 public:
  LayoutFinder(const std::filesystem::path& folder, std::optional<int> obj_num)
      : names_(folder), said_(static_cast<std::size_t>(obj_num.value_or(1))) {
    found_.unsplit = !obj_num.has_value();
    const std::size_t sets = found_.unsplit ? 1 : count_sets(said_);
    for (std::size_t set = 0; set < sets; ++set) find_set(set);
  }
  BakedLayout take() { return std::move(found_); }

 private:
  void lacks(const std::string& name, const std::string& problem) {
    if (found_.missing.empty()) found_.missing = name, found_.problem = problem;
  }

  bool has_geometry(std::size_t set) const {
    return names_.has(geometry_name(Layout::split, set, 0)) || names_.has(geometry_name(Layout::chunked, set, 0)) ||
           names_.has(geometry_name(Layout::chunked, set, 1));
  }
  bool has_textures(std::size_t set) const { return !texture(set, 0).empty() && !texture(set, 1).empty(); }

  // A feature image, also as WebP.
  std::string texture(std::size_t set, int image) const {
    const std::string png = feature_name(found_.unsplit ? Layout::unsplit : Layout::split, set, image);
    const std::string spelt = names_.spelt(png);
    return spelt.empty() ? names_.spelt(png.substr(0, png.size() - 4) + ".webp") : spelt;
  }

  // Counts geometry files from shape0 on, whatever mlp.json says. Sets beyond its obj_num count only if their textures
  // exist too.
  std::size_t count_sets(std::size_t said) {
    std::size_t count = 0;
    while (count < max_texture_sets && has_geometry(count) && (count < said || has_textures(count))) ++count;
    for (std::size_t set = count + 1; count < said && set < count + gap; ++set)
      if (has_geometry(set)) {
        // The sets after it would be lost.
        lacks(geometry_name(Layout::split, count, 0), fmt::format("does not exist, but files of shape{} do", set));
        return count;
      }
    if (count == 0) return 1;  // the missing file is reported
    if (has_geometry(count + (count < said ? 0 : 1)))
      found_.assumptions.push_back(
          fmt::format("files of shape{} are not read: files of an earlier set are missing", count + 1));
    if (count != said)
      found_.assumptions.push_back(fmt::format(
          "mlp.json says obj_num = {}, but the folder contains {} texture sets: all {} are read", said, count, count));
    return count;
  }

  // Appends the chunks of a set. They may be counted from 1, and some may be missing.
  void find_chunks(std::size_t set, BakedLayout::Set& files) {
    std::vector<std::size_t> numbers;
    for (std::size_t j = 0; j < (numbers.empty() ? 2 : numbers.back() + gap); ++j)
      if (const std::string name = names_.spelt(geometry_name(Layout::chunked, set, j)); !name.empty()) {
        files.geometry.push_back(name);
        numbers.push_back(j);
      }
    if (numbers.empty()) return;
    files.needs_repair = numbers.back() + 1 != numbers.size();
    if (files.has_whole) return;
    if (numbers.front() > 0)
      found_.assumptions.push_back(
          fmt::format("shape{} has no chunk 0: its chunks are assumed to be counted from 1", set));
    for (std::size_t j = numbers.front(); j < numbers.back(); ++j)
      if (std::find(numbers.begin(), numbers.end(), j) == numbers.end())
        found_.assumptions.push_back(
            fmt::format("{} is missing: its triangles are lost", geometry_name(Layout::chunked, set, j)));
  }

  void note_spelling(const std::string& spelt, const std::string& name) {
    if (!spelt.empty() && spelt != name && ++respelt_ == 1)
      found_.assumptions.push_back(fmt::format("{} is read as {}, and other files likewise", spelt, name));
  }

  // A backup with another spelling does not count beside chunks, nor do stray chunks beside a whole file.
  void resolve_whole_and_chunks(const std::string& whole, BakedLayout::Set& files) {
    const std::string spelt = files.geometry.front();
    if (spelt != whole) {
      found_.assumptions.push_back(fmt::format("{} is not read: the set has chunks", spelt));
      files.geometry.erase(files.geometry.begin());
      files.has_whole = false;
    } else if (files.needs_repair) {
      found_.assumptions.push_back(
          fmt::format("{} … are not read: chunks are missing, and {} is there", files.geometry[1], whole));
      files.geometry.resize(1);
      files.needs_repair = false;
    }
  }

  void find_set(std::size_t set) {
    BakedLayout::Set& files = found_.sets.emplace_back();
    const Layout naming = found_.unsplit ? Layout::unsplit : Layout::split;
    const std::string whole = geometry_name(naming, set, 0), spelt = names_.spelt(whole);
    files.has_whole = !spelt.empty();
    if (files.has_whole) files.geometry.push_back(spelt);
    if (!found_.unsplit) find_chunks(set, files);
    if (files.has_whole && files.geometry.size() > 1) resolve_whole_and_chunks(whole, files);
    if (files.has_whole) note_spelling(spelt, whole);
    if (files.geometry.empty())
      lacks(whole, found_.unsplit ? std::string("does not exist")
                                  : fmt::format("does not exist (nor {}), but mlp.json says obj_num = {}",
                                                geometry_name(Layout::chunked, set, 0), said_));
    else if (!files.has_whole && !files.needs_repair)
      note_spelling(files.geometry.front(), geometry_name(Layout::chunked, set, 0));
    for (const int image : {0, 1}) {
      files.textures[static_cast<std::size_t>(image)] = texture(set, image);
      if (files.textures[static_cast<std::size_t>(image)].empty())
        lacks(feature_name(naming, set, image), "does not exist");
      note_spelling(files.textures[static_cast<std::size_t>(image)], feature_name(naming, set, image));
    }
  }

  FolderNames names_;
  std::size_t said_;  // obj_num
  BakedLayout found_;
  std::size_t respelt_ = 0;
};

}  // namespace

std::string geometry_name(Layout layout, std::size_t set, std::size_t chunk) {
  if (layout == Layout::unsplit) return "shape.obj";
  if (layout == Layout::split) return fmt::format("shape{}.obj", set);
  return fmt::format("shape{}_{}.obj", set, chunk);
}

std::string feature_name(Layout layout, std::size_t set, int image) {
  if (layout == Layout::unsplit) return fmt::format("shape.pngfeat{}.png", image);
  return fmt::format("shape{}.pngfeat{}.png", set, image);
}

BakedLayout find_baked_layout(const std::filesystem::path& folder, std::optional<int> obj_num) {
  return LayoutFinder(folder, obj_num).take();
}

}  // namespace rebake
