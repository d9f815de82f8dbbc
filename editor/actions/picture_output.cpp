#include "editor/actions/picture_output.h"

#include <fmt/format.h>

#include <cmath>

#include "editor/actions/views.h"
#include "editor/edits/stored_view.h"
#include "mesh_ops/base/counted.h"
#include "mesh_ops/base/error.h"
#include "render/contact_sheet.h"
#include "render/panorama.h"

namespace rebake {

std::vector<std::filesystem::path> files_of(const PictureContent& content, const std::filesystem::path& out) {
  return content.separate && !content.passes.empty() ? pass_files(content.passes, out)
                                                     : std::vector<std::filesystem::path>{out};
}

void refuse_replacing_unnamed(const std::filesystem::path& file, const std::filesystem::path& out) {
  std::error_code error;
  if (file == out) {
    if (std::filesystem::is_regular_file(file, error) && std::filesystem::file_size(file, error) > 0 &&
        !is_rendered_picture(file))
      throw FileError(file,
                      "exists and was not made by Rebake, was changed since, or is of an earlier build; choose another "
                      "name, or remove it first");
    return;
  }
  if (!std::filesystem::exists(std::filesystem::symlink_status(file, error))) return;
  if (std::filesystem::is_symlink(file, error) || !is_rendered_picture(file))
    throw FileError(file,
                    "exists and was not made by Rebake, was changed since, is of an earlier build, or is a link; "
                    "choose another name");
  refuse_replacing_captured(file);
}

void check(const PictureContent& content, const std::filesystem::path& out, int width, int height) {
  check_pass_names(content.passes);
  if (!content.passes.empty() && out.extension() != ".exr")
    throw FieldError("passes", "are written to OpenEXR pictures; name a file that ends in .exr");
  if (!content.passes.empty() && content.panorama) throw FieldError("passes", "cannot be combined with panorama");
  if (content.separate && content.passes.empty()) throw FieldError("separate", "applies to passes only");
  if (content.transparent && !content.passes.empty())
    throw FieldError("transparent", "cannot be combined with passes; choose the passes color and alpha");
  if (content.transparent && !holds_alpha(out)) throw FieldError("transparent", "JPEG has no alpha; choose png");
  if (content.panorama && width != 2 * height) throw FieldError("width", "of a panorama must be twice its height");
}

Image render_to_file(Renderer& renderer, const Scene& scene, const View& view, RenderOptions options,
                     const Lighting* lighting, const PictureContent& content, const std::filesystem::path& out,
                     const SourceGuard& sources) {
  options.transparent = content.transparent;
  if (!content.passes.empty()) {
    const auto passes = render_passes(renderer, scene, view, options, lighting, content.passes);
    for (const std::filesystem::path& file : files_of(content, out)) refuse_replacing_unnamed(file, out);
    write_passes(passes, out, content.separate, sources);
    return {};
  }
  Image picture = content.panorama ? render_panorama(renderer, scene, view, options, lighting)
                                   : renderer.render(scene, view, options, lighting);
  write_rendered(picture, out, sources);
  return picture;
}

void write_rendered(const Image& picture, const std::filesystem::path& out, const SourceGuard& sources) {
  refuse_replacing_unnamed(out, out);
  write_picture(picture, out, sources);
}

Image sheet_of_views(Renderer& renderer, const Scene& scene, const View& view, const PixelSize& cells,
                     const Lighting* lighting, const Progress& progress, const RenderOptions& options) {
  const std::vector<std::string> names = view_names(scene);
  if (names.empty()) throw FieldError("sheet", "the scene has no stored views; store some with the edit view");
  const std::size_t room = static_cast<std::size_t>(cells.width) * static_cast<std::size_t>(cells.height);
  if (names.size() > room)
    throw FieldError("sheet", fmt::format("has room for {}, but the scene has {}", counted(room, "picture"),
                                          counted(names.size(), "stored view")));
  std::vector<Image> pictures;
  for (const std::string& name : names) {
    progress.at("rendering " + name, static_cast<double>(pictures.size()) / static_cast<double>(names.size()));
    View one = view;
    one.camera = fitted(scene, scene.views.at(name), static_cast<double>(view.width) / view.height);
    pictures.push_back(renderer.render(scene, one, options, lighting));
  }
  const auto byte = [](double channel) { return static_cast<std::uint8_t>(std::lround(255 * channel)); };
  const Color& b = scene.background;
  return contact_sheet(pictures, cells.width, std::max(1, view.width / 100), {byte(b.x()), byte(b.y()), byte(b.z())});
}

}  // namespace rebake
