#include "editor/edits/shape/refit.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <map>

#include "editor/edits/describe_edit.h"
#include "editor/edits/select/selecting.h"
#include "mesh_ops/base/counted.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/formats/cameras/camera_formats.h"
#include "mesh_ops/formats/cameras/photographs.h"
#include "mesh_ops/formats/scene_files.h"
#include "mesh_ops/index/index.h"
#include "mesh_ops/refit/photograph_fit.h"
#include "render/photograph_set.h"
#include "render/picture.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

PhotographSource source_of(const Refit& edit) { return {edit.path, edit.format.name, edit.world, edit.scale}; }

std::vector<PhotoCamera> cameras_of(const Refit& edit, std::vector<std::string>& notes) {
  return read_cameras(source_of(edit), notes);
}

constexpr const char* photographs_changed =
    ": cameras or photographs have changed since they were used; restore the original files";

std::string hash_of(const std::vector<fs::path>& files) {
  std::string all;
  for (const fs::path& file : files)
    all += fmt::format("{} {:016x}\n", file.filename().string(), content_hash(read_file(file)));
  return hash_text(content_hash(all));
}

// The nodes that change, with the triangles whose texels do.
std::vector<FitTarget> targets_of(const Scene& scene, const Refit& edit) {
  std::vector<FitTarget> targets;
  for (const PlacedNode& placed : selectable(scene, edit.node)) {
    const std::size_t count_of_all = placed.node->object->triangle_count();
    if (!edit.selection)
      targets.push_back({placed, TriangleSet(count_of_all, 1)});
    else if (placed.node->selection && count(*placed.node->selection) > 0)
      targets.push_back({placed, *placed.node->selection});
  }
  if (targets.empty())
    throw EditError(edit.selection ? "no triangle is selected" : "no object is visible and unlocked");
  return targets;
}

// The photographs for the fit.
std::vector<FitPhotograph> read_all(const Scene& scene, const Refit& edit, const std::vector<PhotoCamera>& cameras,
                                    Report& report, const Progress& progress) {
  PhotographSet set = read_photographs(source_of(edit), cameras, scene.background, progress);
  std::vector<FitPhotograph> photographs;
  std::optional<Renderer> renderer;
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (Photograph& photograph : set.photographs) {
    if (edit.gain) {
      progress.at("comparing exposures", static_cast<double>(photographs.size()) / static_cast<double>(cameras.size()));
      if (!renderer) renderer.emplace();
      View view;
      view.camera = with_planes(photograph.camera, world_bounds(scene),
                                static_cast<double>(photograph.image.width) / photograph.image.height);
      view.width = photograph.image.width;
      view.height = photograph.image.height;
      const Vec3 gain = exposure_gain(photograph, renderer->render(scene, view));
      least = std::min(least, gain.mean());
      most = std::max(most, gain.mean());
      // Brightened or darkened, clipped colours would be wrong ones.
      leave_out_clipped(photograph);
      photograph.image = with_gain(photograph.image, gain.cwiseMax(1e-3).cwiseInverse());
    }
    photographs.push_back(for_fit(std::move(photograph)));
  }
  if (set.missing > 0)
    report.lines.push_back(
        fmt::format("warning: {} of {} missing", set.missing, counted(cameras.size(), "photograph")));
  if (edit.gain)
    report.lines.push_back(fmt::format("exposures of the photographs: gains {:.2f} to {:.2f}", least, most));
  return photographs;
}

}  // namespace

EditSource Refit::input() const { return {path.empty() ? fs::path() : camera_root(path, format.name), content}; }

void Refit::set_input(const EditSource& source) {
  path = source.path.string();
  content = source.content;
  if (!photographs.empty()) return;
  std::vector<std::string> notes;
  photographs = hash_of(named_files(path, cameras_of(*this, notes)));
}

std::vector<fs::path> Refit::input_files() const { return files_with_cameras(path, format.name); }

std::string Refit::input_problem() const {
  try {
    std::vector<std::string> notes;
    const bool same = photographs.empty() || hash_of(named_files(path, cameras_of(*this, notes))) == photographs;
    return same ? "" : path + photographs_changed;
  } catch (const Error& error) {
    return error.what();
  }
}

Outcome apply(const Scene& scene, const Refit& edit, const Progress& progress) {
  if (edit.path.empty()) throw FieldError("path", "is empty");
  if (!(std::isfinite(edit.scale) && edit.scale > 0)) throw FieldError("scale", "must be a number above 0");
  if (edit.epochs < 1 || edit.epochs > 1000) throw FieldError("epochs", "must lie between 1 and 1000");
  Report report;
  const std::vector<PhotoCamera> cameras = cameras_of(edit, report.lines);
  for (std::string& line : report.lines) line = fmt::format("warning: {}: {}", edit.path, line);
  if ((!edit.content.empty() && hash_text(content_hash_at(edit.path)) != edit.content) ||
      (!edit.photographs.empty() && hash_of(named_files(edit.path, cameras)) != edit.photographs))
    throw EditError(edit.path + photographs_changed);
  const std::vector<FitTarget> targets = targets_of(scene, edit);
  std::vector<PlacedNode> occluders = visible_objects(scene);
  for (const FitTarget& target : targets)
    if (!target.placed.visible) occluders.push_back(target.placed);
  FitOfPhotographsOptions options;
  options.decoder = edit.decoder;
  options.epochs = edit.epochs;
  const std::vector<FitPhotograph> photographs = read_all(scene, edit, cameras, report, progress);
  const FitOfPhotographs fit = fit_to_photographs(targets, rays_through(occluders), photographs, options, progress);
  if (fit.seen == 0) throw EditError("the photographs see none of these texels; do the cameras belong to this scene?");
  Scene result = scene;
  for (const FitTarget& target : targets)
    if (const auto changed = fit.objects.find(target.placed.node->id); changed != fit.objects.end())
      result = with_changed(result, target.placed.node->id, [&](Node& node) { node.object = changed->second; });
  report.lines.push_back(fmt::format(
      "fitted {} to {}: root mean square error {:.1f} of 255 before, {:.1f} after{}", counted(fit.seen, "texel"),
      counted(photographs.size(), "photograph"), 255 * fit.before, 255 * fit.after,
      fit.unseen > 0
          ? fmt::format("; {} in no photograph (colours kept)", counted(fit.unseen, "texel is", "texels are"))
          : ""));
  if (fit.after > fit.before)
    report.lines.emplace_back("warning: the error grew: undo this, or fit with more epochs, or without the decoder");
  return {std::move(result), std::move(report)};
}

REBAKE_DESCRIBE_EDIT(
    Refit,
    "Fits the colours of objects to photographs: features of the texels that photographs see, and decoders if wanted.",
    (auto& edit, auto& visit) {
      visit("path", edit.path, Need::required, "camera file or folder of the photographs, as for import_views");
      visit("format", edit.format, Need::optional, "format of the camera file; auto: recognised");
      visit("world", edit.world, Need::optional, "axis that points up in the camera file, as for import_views");
      visit("scale", edit.scale, Need::optional, "factor of the cameras' positions");
      visit("node", edit.node, Need::optional,
            "only this node and its children; default: all visible, unlocked objects");
      visit("selection", edit.selection, Need::optional,
            "only texels of selected triangles; with decoder, the others are fitted to their present colours");
      visit("decoder", edit.decoder, Need::optional,
            "fit the decoders too; always for objects without view dependence, which then get one");
      visit("gain", edit.gain, Need::optional,
            "photographs have different exposures: bring each to that of the scene as it is");
      visit("epochs", edit.epochs, Need::optional, "with decoder: passes over all texels");
      visit("content", edit.content, Need::optional, "expected hash of the cameras; set when the edit is made");
      visit("photographs", edit.photographs, Need::optional,
            "expected hash of the photographs; set when the edit is made");
    })

}  // namespace rebake
