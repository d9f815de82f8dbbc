#include "mesh_ops/formats/cameras/mask_images.h"

#include <fmt/format.h>

#include <map>

#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/images/picture_codecs.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

// The first of these files that exists; empty if none does.
fs::path first_file(const std::vector<fs::path>& candidates) {
  for (const fs::path& candidate : candidates) {
    std::error_code error;
    if (fs::is_regular_file(candidate, error)) return candidate;
  }
  return {};
}

}  // namespace

std::vector<fs::path> mask_files(const std::vector<PhotoCamera>& cameras, const fs::path& base,
                                 const fs::path& folder) {
  std::map<std::string, int> stems;
  for (const PhotoCamera& camera : cameras) ++stems[fs::path(camera.name).stem().string()];
  std::vector<fs::path> files;
  for (const PhotoCamera& camera : cameras) {
    if (folder.empty()) {
      const fs::path inside = camera.mask.lexically_normal();
      if (!inside.empty() && (inside.is_absolute() || *inside.begin() == ".."))
        throw FileError(camera.mask, "is outside the capture's folder; give the folder of the masks");
      files.push_back(inside.empty() ? fs::path() : first_file({base / inside}));
      continue;
    }
    const fs::path photograph = fs::path(camera.name).lexically_normal();
    if (photograph.filename().empty() || photograph.is_absolute() || *photograph.begin() == "..") {
      files.emplace_back();
      continue;
    }
    const fs::path stem = photograph.stem();
    std::vector<fs::path> candidates{folder / photograph.parent_path() / (stem.string() + ".png"),
                                     folder / (photograph.string() + ".png"), folder / photograph};
    if (stems[stem.string()] == 1)
      for (const std::string& name : {stem.string() + ".png", photograph.filename().string() + ".png"})
        candidates.push_back(folder / name);
    files.push_back(first_file(candidates));
  }
  return files;
}

LabelImage read_mask(const fs::path& file) {
  const auto reader = open_picture(file);
  const PictureLayout& layout = reader->layout();
  constexpr int most = 32768;
  if (layout.width > most || layout.height > most)
    throw FileError(file, fmt::format("is larger than {}² pixels", most));
  if (layout.type != "uint8") throw FileError(file, "must have 8 bits per channel; the first channel holds the labels");
  LabelImage mask{layout.width, layout.height, {}};
  mask.labels.resize(static_cast<std::size_t>(mask.width) * static_cast<std::size_t>(mask.height));
  if (!reader->read(0, mask.height, 1, mask.labels.data()))
    throw FileError(file, "cannot be decoded, it may be truncated: " + picture_problem(reader->error(), file));
  return mask;
}

}  // namespace rebake
