#include "editor/edits/nodes/import_views.h"

#include "editor/edits/describe_edit.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "mesh_ops/base/counted.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/formats/cameras/camera_formats.h"
#include "mesh_ops/formats/cameras/photo_names.h"
#include "mesh_ops/formats/scene_files.h"
#include "render/photograph_set.h"

namespace rebake {

EditSource ImportViews::input() const {
  return {path.empty() ? std::filesystem::path() : camera_root(path, format.name), content};
}

void ImportViews::set_input(const EditSource& source) {
  path = source.path.string();
  content = source.content;
}

std::vector<std::filesystem::path> ImportViews::input_files() const { return files_with_cameras(path, format.name); }

Outcome apply(const Scene& scene, const ImportViews& edit) {
  if (edit.path.empty()) throw FieldError("path", "is empty");
  if (!(std::isfinite(edit.scale) && edit.scale > 0)) throw FieldError("scale", "must be a number above 0");
  Report report;
  std::vector<PhotoCamera> cameras;
  for (PhotoCamera& camera : read_cameras(edit.path, edit.format.name, edit.world, report.lines)) {
    camera.eye *= edit.scale;
    cameras.push_back(std::move(camera));
  }
  if (!edit.content.empty() && hash_text(content_hash_at(edit.path)) != edit.content)
    throw EditError(edit.path + ": has changed since its cameras were imported; restore the original files");
  const std::vector<Camera> views = views_of(cameras, report.lines);
  const std::vector<std::string> names = photo_names(cameras);
  Scene result = scene;
  std::size_t replaced = 0;
  for (std::size_t k = 0; k < views.size(); ++k) {
    const bool added = result.views.insert_or_assign(edit.prefix + names[k], views[k]).second;
    replaced += added ? 0 : 1;
  }
  for (std::string& line : report.lines) line = fmt::format("warning: {}: {}", edit.path, line);
  report.lines.push_back(fmt::format("stored {}", counted(views.size(), "view")) +
                         (replaced > 0 ? fmt::format(", {} in place of views of the same name", replaced) : ""));
  return {std::move(result), std::move(report)};
}

std::string whole_title(const ImportViews& edit) {
  return "Imported views of " + std::filesystem::path(edit.path).filename().string();
}

REBAKE_DESCRIBE_EDIT(
    ImportViews, "Stores the cameras of photographs as named views.", (auto& edit, auto& visit) {
      visit("path", edit.path, Need::required,
            "camera file or folder: transforms.json (NeRF, nerfstudio, instant-ngp), a COLMAP model, poses_bounds.npy, "
            "or a camera path of nerfstudio or instant-ngp");
      visit("format", edit.format, Need::optional, "format of the file; auto: recognised");
      visit("prefix", edit.prefix, Need::optional, "start of the views' names; the photographs' names follow");
      visit("world", edit.world, Need::optional,
            "axis that points up in the file; default: z_up, but y_up for COLMAP and poses_bounds.npy");
      visit("scale", edit.scale, Need::optional, "factor of the cameras' positions");
      visit("content", edit.content, Need::optional,
            "expected hash of the camera files, from projects and journals; other contents are refused");
    })

}  // namespace rebake
