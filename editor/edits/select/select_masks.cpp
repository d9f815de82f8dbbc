#include "editor/edits/select/select_masks.h"

#include "editor/edits/describe_edit.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <set>

#include "mesh_ops/base/counted.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/formats/cameras/camera_formats.h"
#include "mesh_ops/formats/cameras/coco_masks.h"
#include "mesh_ops/formats/cameras/mask_images.h"
#include "mesh_ops/formats/cameras/photographs.h"
#include "mesh_ops/formats/scene_files.h"
#include "render/photograph_set.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

// Cameras with the files of their masks.
struct Photographs {
  std::vector<PhotoCamera> cameras;
  std::vector<fs::path> masks;  // empty where there is none
  fs::path coco;                // file with all masks; then `masks` is empty
};

Photographs photographs_of(const SelectMasks& edit, std::vector<std::string>& notes) {
  Photographs found;
  found.cameras = read_cameras(edit.path, edit.format.name, edit.world, notes);
  std::error_code error;
  const fs::path base = capture_folder(edit.path);
  const bool stated = std::any_of(found.cameras.begin(), found.cameras.end(),
                                  [](const PhotoCamera& camera) { return !camera.mask.empty(); });
  const fs::path folder = !edit.masks.empty() ? base / edit.masks : stated ? fs::path() : base / "masks";
  if (fs::is_regular_file(folder, error)) {
    found.coco = folder;
    return found;
  }
  found.masks = mask_files(found.cameras, base, folder);
  if (std::all_of(found.masks.begin(), found.masks.end(), [](const fs::path& file) { return file.empty(); }))
    throw FieldError(
        "masks", fmt::format("there are no masks {}; their names are those of the photographs",
                             folder.empty() ? "at the places that the camera file names" : "in " + folder.string()));
  return found;
}

// The files with masks.
std::vector<fs::path> files_of(const Photographs& found) {
  std::vector<fs::path> files = found.masks;
  if (!found.coco.empty()) files.push_back(found.coco);
  std::erase(files, fs::path());
  return files;
}

constexpr const char* masks_changed =
    ": cameras or masks have changed since they were used; restore the original files";

std::string hash_of(const Photographs& found) {
  ContentHash hash;
  for (const fs::path& file : files_of(found))
    hash.add(fmt::format("{} {:016x}\n", file.filename().string(), content_hash(read_file(file))));
  return hash_text(hash.value());
}

void check(const SelectMasks& edit) {
  if (edit.path.empty()) throw FieldError("path", "is empty");
  if (!(edit.scale > 0) || !std::isfinite(edit.scale)) throw FieldError("scale", "must be a number above 0");
  if (!(edit.threshold > 0 && edit.threshold <= 1)) throw FieldError("threshold", "must be above 0 and at most 1");
  for (const int label : edit.labels)
    if (label < 1 || label > 255) throw FieldError("labels", "must lie between 1 and 255");
  if (std::set(edit.labels.begin(), edit.labels.end()).size() < edit.labels.size())
    throw FieldError("labels", "contains a label twice");
  if (edit.labels.empty() && !edit.store.empty()) throw FieldError("store", "needs labels");
}

// The votes of all photographs, of which only some are in memory at a time.
class Voting {
 public:
  Voting(const SelectMasks& edit, const Photographs& found, const std::vector<PlacedNode>& targets,
         const std::vector<PlacedNode>& occluders, const Progress& progress)
      : targets_(targets), occluders_(occluders), progress_(progress), labels_(edit.labels.begin(), edit.labels.end()) {
    std::optional<CocoMasks> coco;
    if (!found.coco.empty()) coco.emplace(found.coco, found.cameras);
    // Without labels, bright pixels and all categories are inside.
    const int least = coco ? 1 : 128;
    if (edit.labels.empty()) labels_ = {1};
    for (std::size_t k = 0; k < found.cameras.size(); ++k) {
      if (coco ? !coco->has(k) : found.masks[k].empty()) continue;
      batch_.push_back({found.cameras[k], coco ? coco->mask(k, edit.labels) : read_mask(found.masks[k])});
      batch_.back().camera.eye *= edit.scale;
      if (edit.labels.empty())
        for (std::uint8_t& label : batch_.back().mask.labels) label = label >= least ? 1 : 0;
      bytes_ += batch_.back().mask.labels.size();
      ++photographs_;
      constexpr std::size_t most_bytes = std::size_t{512} << 20;
      if (bytes_ > most_bytes) count_batch();
    }
    if (photographs_ == 0) throw FieldError("masks", found.coco.string() + " has no masks for these photographs");
    count_batch();
  }
  const std::vector<MaskVotes>& votes() const { return votes_; }
  const std::vector<std::uint8_t>& labels() const { return labels_; }
  std::size_t photographs() const { return photographs_; }

 private:
  void count_batch() {
    if (batch_.empty()) return;
    std::vector<MaskVotes> more = mask_votes(targets_, occluders_, batch_, labels_, progress_);
    if (votes_.empty())
      votes_ = std::move(more);
    else
      add_votes(votes_, more);
    batch_.clear();
    bytes_ = 0;
  }

  const std::vector<PlacedNode>&targets_, &occluders_;
  const Progress& progress_;
  std::vector<std::uint8_t> labels_;
  std::vector<MaskedPhoto> batch_;
  std::size_t bytes_ = 0, photographs_ = 0;
  std::vector<MaskVotes> votes_;
};

}  // namespace

EditSource SelectMasks::input() const {
  return {path.empty() ? std::filesystem::path() : camera_root(path, format.name), content};
}

void SelectMasks::set_input(const EditSource& source) {
  path = source.path.string();
  content = source.content;
  // Relative to the capture, so that masks are found again when both have moved.
  if (fs::path(masks).is_absolute()) {
    std::error_code error;
    const fs::path base = capture_folder(path), relative = fs::path(masks).lexically_relative(base);
    // Not through links, which make ".." lead elsewhere.
    if (!relative.empty() && fs::equivalent(base / relative, masks, error)) masks = relative.string();
  }
  if (!masks_content.empty()) return;
  std::vector<std::string> notes;
  masks_content = hash_of(photographs_of(*this, notes));
}

std::vector<fs::path> SelectMasks::input_files() const {
  std::vector<fs::path> files = files_with_cameras(path, format.name);
  std::vector<std::string> notes;
  for (fs::path& mask : files_of(photographs_of(*this, notes))) files.push_back(std::move(mask));
  return files;
}

std::string SelectMasks::input_problem() const {
  try {
    std::vector<std::string> notes;
    return masks_content.empty() || hash_of(photographs_of(*this, notes)) == masks_content ? "" : path + masks_changed;
  } catch (const Error& error) {
    return error.what();
  }
}

Outcome apply(const Scene& scene, const SelectMasks& edit, const Progress& progress) {
  check(edit);
  Report report;
  const Photographs found = photographs_of(edit, report.lines);
  if ((!edit.content.empty() && hash_text(content_hash_at(edit.path)) != edit.content) ||
      (!edit.masks_content.empty() && hash_of(found) != edit.masks_content))
    throw EditError(edit.path + masks_changed);
  for (std::string& line : report.lines) line = fmt::format("warning: {}: {}", edit.path, line);
  const std::vector<PlacedNode> targets = selectable(scene, edit.node);
  std::vector<PlacedNode> occluders = visible_objects(scene);
  for (const PlacedNode& target : targets)
    if (!target.visible) occluders.push_back(target);
  const Voting voting(edit, found, targets, occluders, progress);
  std::size_t seen = 0, target = 0;
  double agreeing = 0;
  std::vector<std::vector<TriangleSet>> chosen;
  Scene result = with_selected(scene, targets, edit.mode, [&](const PlacedNode&) {
    MaskDecision decision = decide(voting.votes()[target++], edit.threshold);
    seen += decision.seen;
    agreeing += decision.consistency * static_cast<double>(decision.seen);
    chosen.push_back(std::move(decision.chosen));
    return std::move(decision.any);
  });
  if (!edit.store.empty())
    for (std::size_t t = 0; t < targets.size(); ++t)
      result = with_changed(result, targets[t].node->id, [&](Node& node) {
        for (std::size_t k = 0; k < voting.labels().size(); ++k)
          node.saved_selections[fmt::format("{} {}", edit.store, voting.labels()[k])] =
              std::make_shared<const TriangleSet>(chosen[t][k]);
      });
  report.lines.push_back(fmt::format("masks for {} of {}; they see {} and agree on {:.1f} %", voting.photographs(),
                                     counted(found.cameras.size(), "photograph"), counted(seen, "triangle"),
                                     seen > 0 ? 100 * agreeing / static_cast<double>(seen) : 0.0));
  return {std::move(result), std::move(report)};
}

REBAKE_DESCRIBE_EDIT(
    SelectMasks,
    "Selects triangles that are inside masks of photographs: up to four opaque points of each triangle vote in each "
    "photograph that sees them.",
    (auto& edit, auto& visit) {
      visit("path", edit.path, Need::required, "camera file or folder, as for import_views");
      visit("format", edit.format, Need::optional, "format of the camera file; auto: recognised");
      visit(
          "masks", edit.masks, Need::optional,
          "folder of masks named like the photographs, or a COCO file with run lengths, relative to the folder of the "
          "capture; default: as the camera file says, else masks");
      visit("world", edit.world, Need::optional, "axis that points up in the camera file, as for import_views");
      visit("scale", edit.scale, Need::optional, "factor of the cameras' positions");
      visit("node", edit.node, Need::optional,
            "only this node and its children; default: all visible, unlocked objects");
      visit("labels", edit.labels, Need::optional,
            "values of pixels, or COCO categories, that are inside, 1 to 255; default: 128 to 255, or all categories. "
            "Where several of these categories overlap, the last annotation of the file counts");
      visit("threshold", edit.threshold, Need::optional,
            "share of the votes that a triangle needs, above 0, at most 1");
      visit("store", edit.store, Need::optional,
            "with labels: stores the triangles of each as the selection \"NAME LABEL\"");
      visit("mode", edit.mode, Need::optional, "how to combine the result with the present selection");
      visit("content", edit.content, Need::optional, "expected hash of the camera files, from projects and journals");
      visit("masks_content", edit.masks_content, Need::optional,
            "expected hash of the masks, from projects and journals");
    })

}  // namespace rebake
