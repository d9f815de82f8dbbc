#include "render/photograph_set.h"

#include <algorithm>

#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/cameras/camera_formats.h"
#include "mesh_ops/formats/cameras/photographs.h"
#include "render/image.h"

namespace rebake {

std::vector<PhotoCamera> read_cameras(const PhotographSource& source, std::vector<std::string>& notes) {
  std::vector<PhotoCamera> cameras = read_cameras(source.path, source.format, source.world, notes);
  for (PhotoCamera& camera : cameras) {
    camera.eye *= source.scale;
    camera.near_plane *= source.scale;
    camera.far_plane *= source.scale;
  }
  return cameras;
}

std::vector<std::filesystem::path> files_with_cameras(const std::filesystem::path& camera_file,
                                                      const std::string& format) {
  std::vector<std::string> notes;
  const std::vector<PhotoCamera> cameras = read_cameras(camera_file, format, {}, notes);
  std::vector<std::filesystem::path> files = camera_format_for(camera_file, format).files(camera_file);
  for (std::filesystem::path& file : named_files(camera_file, cameras)) files.push_back(std::move(file));
  for (std::filesystem::path& file : capture_files(camera_file, cameras))
    if (!is_rendered_picture(file)) files.push_back(std::move(file));
  return files;
}

PhotographSet read_photographs(const PhotographSource& source, const std::vector<PhotoCamera>& cameras,
                               const Vec3& background, const Progress& progress) {
  std::vector<std::string> dropped;
  const std::vector<Camera> views = views_of(cameras, dropped);
  const std::filesystem::path folder = capture_folder(source.path);
  PhotographSet set;
  for (std::size_t k = 0; k < cameras.size(); ++k) {
    progress.at("reading photographs", static_cast<double>(k) / static_cast<double>(cameras.size()));
    if (photograph_at(folder, cameras[k].name).empty()) {
      // Names may not leave the folder: another file could be meant on another machine.
      const bool outside = std::filesystem::path(cameras[k].name).lexically_normal().string().starts_with("..");
      if (set.missing++ == 0)
        set.first_missing = cameras[k].name + (outside ? " (outside the folder of the camera file)" : "");
      continue;
    }
    Photograph photograph = read_photograph(cameras[k], views[k], folder, background);
    set.resampled += photograph.resampled ? 1 : 0;
    if (std::find(photograph.valid.begin(), photograph.valid.end(), 1) == photograph.valid.end()) {
      ++set.masked;
      continue;
    }
    set.cameras.push_back(cameras[k]);
    set.photographs.push_back(std::move(photograph));
  }
  if (set.photographs.empty())
    throw FileError(source.path,
                    "none of its photographs exists and shows something" +
                        (set.first_missing.empty() ? std::string() : "; the first is \"" + set.first_missing + "\""));
  return set;
}

FitPhotograph for_fit(Photograph photograph) {
  return {photograph.camera, photograph.image.width, photograph.image.height, std::move(photograph.image.rgb),
          std::move(photograph.valid)};
}

}  // namespace rebake
