#include "editor/actions/export_views.h"

#include "editor/actions/describe_action.h"
#include "editor/document/replaced_work.h"
#include "editor/edits/stored_view.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "mesh_ops/base/counted.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/cameras/camera_formats.h"
#include "mesh_ops/formats/cameras/camera_mark.h"
#include "mesh_ops/formats/cameras/photographs.h"

namespace rebake {

namespace {

bool wrote(const std::filesystem::path& path) {
  const nlohmann::json root = nlohmann::json::parse(read_file(path), nullptr, false);
  return has_camera_mark(root) && (root.contains("frames") || root.contains("camera_path"));
}

// Cameras in a file are poses that nobody may be able to make again: only files that this action wrote are replaced.
void refuse_replacing_cameras(const std::filesystem::path& path, const std::vector<std::string>& names) {
  std::error_code error;
  if (!std::filesystem::exists(path, error) ||
      (std::filesystem::is_regular_file(path, error) && std::filesystem::file_size(path, error) == 0))
    return;
  const auto refuse = [&](const std::string& what) {
    throw FileError(path, what + ", so it is not replaced; choose another name, or remove it first");
  };
  const CameraFormat* there = camera_format_at(path);
  const bool own = std::filesystem::is_regular_file(path, error) && wrote(path);
  if (there == nullptr) {
    // Only files that end in .json are recognised.
    if (!own) refuse("exists and is not a camera file of Rebake, was changed since, or is of an earlier build");
    return;
  }
  if (there->write == nullptr) refuse(fmt::format("has cameras in the format {}, which is not written", there->name));
  std::vector<std::string> notes;
  const std::vector<PhotoCamera> cameras = read_cameras(path, "", {}, notes);
  if (cameras.size() > names.size())
    refuse(fmt::format("has {}, more than the {} to be written", counted(cameras.size(), "camera"), names.size()));
  const bool same = std::all_of(cameras.begin(), cameras.end(), [&](const PhotoCamera& camera) {
    return std::find(names.begin(), names.end(), std::filesystem::path(camera.name).stem().string()) != names.end();
  });
  if (!own) refuse("has cameras that Rebake did not write, that were changed since, or that are of an earlier build");
  if (!same && !capture_files(path, cameras).empty()) refuse("has the cameras of photographs beside it");
}

}  // namespace

void run(Session& session, const ExportViewsAction& action) {
  if (action.out.empty()) throw FieldError("out", "is empty");
  refuse_replacing_work(action.out);
  session.document.sources().check_file(action.out);
  if (action.width < 1 || action.width > 1 << 20) throw FieldError("width", "must lie between 1 and 1048576");
  if (action.height < 1 || action.height > 1 << 20) throw FieldError("height", "must lie between 1 and 1048576");
  const CameraFormat& format = camera_format_named(action.format.name.empty() ? "transforms" : action.format.name);
  if (format.write == nullptr)
    throw FieldError("format",
                     fmt::format("{} is only read; use {}", format.name, fmt::join(written_camera_formats(), " or ")));
  const Scene scene = session.scene();
  const std::vector<std::string> names = action.views.empty() ? view_names(scene) : action.views;
  if (names.empty()) throw FieldError("views", "is empty, and the scene has no stored views");
  std::vector<PhotoCamera> cameras;
  refuse_replacing_cameras(action.out, names);
  for (const std::string& name : names)
    cameras.push_back(photo_camera(stored_view(scene, name, "views"), name + ".png", action.width, action.height));
  write_file_atomically(action.out, format.write(from_y_up(std::move(cameras), action.world.value_or(format.up))),
                        session.document.sources());
  session.outputs.push_back(action.out);
  session.say(fmt::format("wrote {} to {}", counted(names.size(), "view"), action.out));
}

REBAKE_DESCRIBE_ACTION(
    ExportViewsAction, "Writes stored views as a camera file.", (auto& action, auto& visit) {
      visit("out", action.out, Need::required, "file to write");
      visit("format", action.format, Need::optional,
            "transforms: transforms.json of NeRF, nerfstudio and instant-ngp; nerfstudio_path: camera_path.json");
      visit("views", action.views, Need::optional, "names of stored views; default: all");
      visit("width", action.width, Need::optional, "width of the pictures", Unit::pixels);
      visit("height", action.height, Need::optional, "height of the pictures", Unit::pixels);
      visit("world", action.world, Need::optional, "axis that points up in the file; default: z_up");
    })

}  // namespace rebake
