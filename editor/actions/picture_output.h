#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "editor/fields/values.h"

#include "render/image_passes.h"
#include "render/picture.h"

namespace rebake {

/// What a picture file shows, beside a view.
struct PictureContent {
  bool transparent = false;         ///< alpha in place of the background
  bool panorama = false;            ///< all directions, equirectangular
  std::vector<std::string> passes;  ///< channels for compositing; empty: colours only
  bool separate = false;            ///< a file for each pass

  /// The fields that pictures and films have.
  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("transparent", self.transparent, Need::optional, "no background, but alpha; not for JPEG");
    visit("panorama", self.panorama, Need::optional,
          "all directions in an equirectangular picture, twice as wide as high");
    visit("passes", self.passes, Need::optional,
          "channels of an OpenEXR picture, of color, alpha, depth, normal, node, position and light");
  }
};

/// Throws FileError if `file`, one of files_of(), would replace something else than a picture that Rebake rendered, or,
/// for a file of a pass, which the user has not named, a link.
void refuse_replacing_unnamed(const std::filesystem::path& file, const std::filesystem::path& out);

/// The files that are written for `out`: itself, or one for each pass.
std::vector<std::filesystem::path> files_of(const PictureContent& content, const std::filesystem::path& out);

/// Throws FieldError if a file of this name cannot hold the content, or if fields do not go together.
void check(const PictureContent& content, const std::filesystem::path& out, int width, int height);

/// Renders a picture and writes it. Returns the picture, empty for passes. Throws as write_picture(), write_passes()
/// and refuse_replacing_unnamed() do, the last also for files that appeared while it was rendered.
Image render_to_file(Renderer& renderer, const Scene& scene, const View& view, RenderOptions options,
                     const Lighting* lighting, const PictureContent& content, const std::filesystem::path& out,
                     const SourceGuard& sources);

/// Writes a picture. Throws as write_picture() does, and FileError if the file would replace something else than a
/// picture that Rebake rendered.
void write_rendered(const Image& picture, const std::filesystem::path& out, const SourceGuard& sources);

/// A contact sheet of all stored views in natural order, in `cells` columns and rows. `view`: size of each picture and
/// samples. Throws FieldError if there are no views, or more than cells.
Image sheet_of_views(Renderer& renderer, const Scene& scene, const View& view, const PixelSize& cells,
                     const Lighting* lighting, const Progress& progress, const RenderOptions& options = {});

}  // namespace rebake
