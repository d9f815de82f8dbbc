#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "editor/gui/window/desk.h"
#include "render/picture.h"
#include "render/picture_texture.h"

namespace rebake {

/// Small pictures of stored views, and of what was opened before.
class Thumbnails {
 public:
  static constexpr int width = 192, height = 120;

  /// A texture of what a stored view of the scene, as it is drawn, shows; 0 while there is none yet. One that is out of
  /// date is shown until draw_one() has made it anew.
  unsigned of_view(const Scene& scene, const std::string& name);
  /// Of no view any more.
  void forget_views();
  /// A texture of what was seen of a file or folder last; 0 where nothing is kept of it.
  unsigned of_file(const std::string& path);

  /// A texture of a PNG; 0 if it is not there or damaged.
  unsigned of_picture(const std::filesystem::path& png);

  /// Whether draw_one() has something to do.
  bool wants() const { return wanted_.has_value(); }
  /// Draws what was asked for last. The renderer's picture is another one then. A view that cannot be drawn has no
  /// picture.
  void draw_one(Renderer& renderer, const Scene& scene);
  /// Keeps a picture of what is seen of a file or folder, and no longer those of what is not among `recent`.
  void keep(const std::string& path, const std::vector<std::string>& recent, const Image& seen);

 private:
  struct OfView {
    Camera camera;
    std::vector<NodePtr> roots;
    Color background;
    std::optional<PictureTexture> picture;  ///< none where it could not be drawn
  };
  std::map<std::string, OfView> views_;
  std::map<std::filesystem::path, std::optional<PictureTexture>> files_;  ///< by their PNG
  std::optional<std::string> wanted_;                                     ///< a view's name
};

}  // namespace rebake
