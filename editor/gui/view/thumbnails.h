#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "editor/gui/state/editor_context.h"
#include "render/picture.h"
#include "render/picture_texture.h"

namespace rebake {

/// Thumbnails of stored views (drawn on request) and of recent files (cached on disk as PNG).
class Thumbnails {
 public:
  static constexpr int width = 192, height = 120;

  /// OpenGL texture of a stored view of the scene; 0 if it is not drawn yet. A missing or outdated thumbnail is
  /// requested from draw_one(); the outdated one is returned until then.
  unsigned of_view(const Scene& scene, const std::string& name);
  /// Frees the thumbnails of all views.
  void forget_views();
  /// OpenGL texture of the cached thumbnail of a file or folder; 0 if there is none.
  unsigned of_file(const std::string& path);

  /// OpenGL texture of a PNG file; 0 if it is missing. A damaged file is deleted.
  unsigned of_picture(const std::filesystem::path& png);

  /// Whether a thumbnail is requested.
  bool wants() const { return wanted_.has_value(); }
  /// Draws the thumbnail that was requested last; call only if wants(). Replaces the renderer's current picture. A view
  /// that cannot be drawn gets no thumbnail.
  void draw_one(Renderer& renderer, const Scene& scene);
  /// Caches `seen` as the thumbnail of a file or folder on disk, and deletes those of all others that are not in
  /// `recent`. Throws FileError or std::filesystem::filesystem_error.
  void keep(const std::string& path, const std::vector<std::string>& recent, const Image& seen);

 private:
  struct OfView {
    Camera camera;
    std::vector<NodePtr> roots;
    Color background;
    std::optional<PictureTexture> picture;  ///< none if the view could not be drawn
  };
  std::map<std::string, OfView> views_;
  std::map<std::filesystem::path, std::optional<PictureTexture>> files_;  ///< by path of the PNG
  std::optional<std::string> wanted_;                                     ///< name of the requested view
};

}  // namespace rebake
