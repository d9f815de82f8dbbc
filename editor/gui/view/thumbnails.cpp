#include "editor/gui/view/thumbnails.h"

#include <set>
#include <utility>

#include "editor/actions/views.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/hash.h"
#include "render/thumbnail.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

fs::path picture_file(const std::string& path) {
  return cache_folder() / "pictures" / (hash_text(content_hash(path)) + ".png");
}

// Whether it has the name of a picture_file(), not that of a picture that somebody put there.
bool has_own_name(const fs::path& file) {
  const std::string hash = file.stem().string();
  return file.extension() == ".png" && hash.size() == hash_text(0).size() &&
         hash.find_first_not_of("0123456789abcdef") == std::string::npos;
}

}  // namespace

unsigned Thumbnails::of_view(const Scene& scene, const std::string& name) {
  const auto found = views_.find(name);
  const Camera& camera = scene.views.at(name);
  if (found == views_.end() || !(found->second.camera == camera) || found->second.roots != scene.roots ||
      found->second.background != scene.background)
    wanted_ = name;
  return found == views_.end() || !found->second.picture ? 0 : found->second.picture->name();
}

void Thumbnails::draw_one(Renderer& renderer, const Scene& scene) {
  const std::string name = *std::exchange(wanted_, std::nullopt);
  const auto found = scene.views.find(name);
  if (found == scene.views.end()) return;
  View view;
  view.width = width;
  view.height = height;
  view.camera = fitted(scene, found->second, static_cast<double>(width) / height);
  std::erase_if(views_, [&](const auto& one) { return !scene.views.contains(one.first); });
  std::optional<PictureTexture> picture;
  try {
    picture.emplace(renderer.render(scene, view));
  } catch (const Error&) {
    // The viewport reports the same error.
  }
  views_.insert_or_assign(name, OfView{found->second, scene.roots, scene.background, std::move(picture)});
}

void Thumbnails::forget_views() {
  views_.clear();
  wanted_.reset();
}

unsigned Thumbnails::of_file(const std::string& path) { return of_picture(picture_file(path)); }

unsigned Thumbnails::of_picture(const fs::path& file) {
  auto found = files_.find(file);
  if (found == files_.end()) {
    found = files_.emplace(file, std::nullopt).first;
    std::error_code unknown;
    if (fs::is_regular_file(file, unknown)) try {
        found->second.emplace(read_image(file));
      } catch (const Error&) {
        fs::remove(file, unknown);  // damaged: written again when the scene is opened next time
      }
  }
  return found->second ? found->second->name() : 0;
}

void Thumbnails::keep(const std::string& path, const std::vector<std::string>& recent, const Image& seen) {
  const fs::path file = picture_file(path);
  fs::create_directories(file.parent_path());
  std::set<fs::path> wanted = {file};
  for (const std::string& one : recent) wanted.insert(picture_file(one));
  for (const fs::directory_entry& entry : fs::directory_iterator(file.parent_path()))
    if (std::error_code error;
        !wanted.contains(entry.path()) && has_own_name(entry.path()) && is_rendered_picture(entry.path()))
      fs::remove(entry.path(), error);
  write_picture(thumbnail_of(seen, width, height), file, {});
  files_.erase(file);
}

}  // namespace rebake
