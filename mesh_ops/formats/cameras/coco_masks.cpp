#include "mesh_ops/formats/cameras/coco_masks.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/cameras/json_file.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

using nlohmann::json;

constexpr std::int64_t largest_side = 32768;

std::int64_t whole(const json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_number_integer()) throw FieldError(key, "must be a whole number");
  return found->get<std::int64_t>();
}

int side(const json& value, const char* key) {
  if (!value.is_number_integer() || value < 1 || value > largest_side)
    throw FieldError(key, fmt::format("must lie between 1 and {}", largest_side));
  return value.get<int>();
}

// Run lengths from their text: base 32 with a sign, as differences to the run before the last.
std::vector<std::int64_t> decoded_runs(const std::string& text) {
  std::vector<std::int64_t> runs;
  for (std::size_t at = 0; at < text.size();) {
    std::int64_t value = 0;
    bool more = true;
    for (int digit = 0; more; ++digit) {
      constexpr int most_digits = 7;
      if (at == text.size() || digit == most_digits) throw FieldError("counts", "is truncated or too long");
      const int code = text[at++] - 48;
      if (code < 0 || code > 63) throw FieldError("counts", "contains other characters than those of run lengths");
      value |= static_cast<std::int64_t>(code & 31) << (5 * digit);
      more = (code & 32) != 0;
      if (!more && (code & 16) != 0) value |= -(std::int64_t{1} << (5 * (digit + 1)));
    }
    if (runs.size() > 2) value += runs[runs.size() - 2];
    runs.push_back(value);
  }
  return runs;
}

std::vector<std::int64_t> runs_of(const json& segmentation) {
  const auto counts = segmentation.find("counts");
  if (counts == segmentation.end()) throw FieldError("counts", "is missing");
  if (counts->is_string()) return decoded_runs(counts->get<std::string>());
  if (!counts->is_array()) throw FieldError("counts", "must be a text or a list of run lengths");
  std::vector<std::int64_t> runs;
  for (const json& run : *counts) {
    if (!run.is_number_integer()) throw FieldError("counts", "must contain whole numbers");
    runs.push_back(run.get<std::int64_t>());
  }
  return runs;
}

// Throws FieldError if the runs do not cover the picture exactly.
void check_runs(const std::vector<std::int64_t>& runs, std::int64_t pixels) {
  std::int64_t at = 0;
  for (const std::int64_t run : runs) {
    if (run < 0 || run > pixels - at) throw FieldError("counts", "does not fit the size");
    at += run;
  }
  if (at != pixels) throw FieldError("counts", "does not fit the size");
}

// The camera of a photograph with this path; the number of cameras if there is none.
std::size_t camera_of(const std::string& name, const std::vector<PhotoCamera>& cameras) {
  std::vector<std::size_t> same_file;
  const fs::path file = fs::path(name).filename();
  for (std::size_t k = 0; k < cameras.size(); ++k) {
    if (cameras[k].name == name) return k;
    if (!file.empty() && fs::path(cameras[k].name).filename() == file) same_file.push_back(k);
  }
  if (same_file.size() > 1)
    throw FieldError("file_name", fmt::format("\"{}\" fits {} photographs; write its path as the camera file does",
                                              name, same_file.size()));
  return same_file.empty() ? cameras.size() : same_file.front();
}

const json& list(const json& root, const char* key, const fs::path& file) {
  const auto found = root.find(key);
  if (found == root.end() || !found->is_array()) throw FileError(file, fmt::format("has no list \"{}\"", key));
  return *found;
}

// Calls `use` with each entry of a list; errors get the file, the list and the number.
template <class Use>
void for_each_entry(const json& root, const char* key, const fs::path& file, const Use& use) {
  std::size_t number = 0;
  for (const json& entry : list(root, key, file)) {
    try {
      if (!entry.is_object()) throw FieldError(key, "must contain objects");
      use(entry);
    } catch (const FieldError& error) {
      throw FileError(file, fmt::format("{}[{}]: {}", key, number, error.what()));
    }
    ++number;
  }
}

}  // namespace

CocoMasks::CocoMasks(const fs::path& file, const std::vector<PhotoCamera>& cameras) : masks_(cameras.size()) {
  const json root = read_json_object(file);
  std::map<std::int64_t, std::size_t> camera_of_image;
  for_each_entry(root, "images", file, [&](const json& image) {
    const auto name = image.find("file_name");
    if (name == image.end() || !name->is_string()) throw FieldError("file_name", "must be a text");
    const std::size_t camera = camera_of(name->get<std::string>(), cameras);
    camera_of_image[whole(image, "id")] = camera;
    if (camera == cameras.size()) return;
    const auto size = [&](const char* key) { return image.contains(key) ? side(image.at(key), key) : 0; };
    masks_[camera].width = size("width") > 0 ? size("width") : cameras[camera].width;
    masks_[camera].height = size("height") > 0 ? size("height") : cameras[camera].height;
    const auto pixels = [](std::int64_t width, std::int64_t height) { return width * height; };
    if (pixels(masks_[camera].width, masks_[camera].height) > 4 * pixels(cameras[camera].width, cameras[camera].height))
      throw FieldError("width", "is much larger than the photograph");
  });
  for_each_entry(root, "annotations", file, [&](const json& annotation) {
    const auto image = camera_of_image.find(whole(annotation, "image_id"));
    if (image == camera_of_image.end()) throw FieldError("image_id", "is not the id of an image");
    if (image->second == cameras.size()) return;
    Mask& mask = masks_[image->second];
    const std::int64_t label = whole(annotation, "category_id");
    if (label < 1 || label > 255) throw FieldError("category_id", "must lie between 1 and 255");
    const auto segmentation = annotation.find("segmentation");
    if (segmentation == annotation.end() || !segmentation->is_object())
      throw FieldError("segmentation", "must be run lengths with counts and size; polygons are not read");
    const auto size = segmentation->find("size");
    if (size == segmentation->end() || !size->is_array() || size->size() != 2)
      throw FieldError("size", "must be [height, width]");
    if (side((*size)[0], "size") != mask.height || side((*size)[1], "size") != mask.width)
      throw FieldError("size", "differs from that of the image");
    std::vector<std::int64_t> runs = runs_of(*segmentation);
    check_runs(runs, std::int64_t{mask.width} * mask.height);
    mask.annotations.push_back({static_cast<std::uint8_t>(label), std::move(runs)});
  });
}

LabelImage CocoMasks::mask(std::size_t camera, const std::vector<int>& labels) const {
  const Mask& mask = masks_[camera];
  LabelImage image{mask.width, mask.height, {}};
  image.labels.resize(static_cast<std::size_t>(mask.width) * static_cast<std::size_t>(mask.height));
  for (const Annotation& annotation : mask.annotations) {
    if (!labels.empty() && std::find(labels.begin(), labels.end(), annotation.label) == labels.end()) continue;
    std::int64_t at = 0;
    bool inside = false;
    for (const std::int64_t run : annotation.runs) {
      for (std::int64_t k = at; inside && k < at + run; ++k)
        image.labels[static_cast<std::size_t>(k % mask.height * mask.width + k / mask.height)] = annotation.label;
      at += run;
      inside = !inside;
    }
  }
  return image;
}

}  // namespace rebake
