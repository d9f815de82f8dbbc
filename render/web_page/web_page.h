#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/formats/motion_samples.h"
#include "mesh_ops/light/lighting.h"
#include "mesh_ops/scene/scene.h"
#include "render/web_page/web_image.h"

namespace rebake {

/// Choices of a web page.
struct WebPageOptions {
  std::string title;
  Vec3 up{0, 1, 0};                     ///< axis of the orbit and the turntable, unit
  Camera home;                          ///< camera at the start
  std::map<std::string, Camera> views;  ///< named views, with all planes set
  /// Positions lie on a grid with at least this many steps per pixel of a picture of `home_height` pixels by the home
  /// camera, at the point nearest to it.
  double steps_per_pixel = 256;
  int home_height = 800;
  WebImageCoding coding = WebImageCoding::smaller;  ///< of textures
  bool single_file = false;                         ///< everything in index.html, which then works without a server
  bool transparent = false;                         ///< no background: an embedding page shows through
  std::map<std::string, std::string> thumbnails;    ///< PNGs of views, by name
  std::string poster;                               ///< PNG of `home`, shown until the scene is loaded; empty: none
};

/// A scene in the colours of its lighting.
struct LitScene {
  const Scene& scene;
  const Lighting& lighting;
  const std::map<NodeId, BendPoses>* poses = nullptr;  ///< see posed_scene(); null: no node bends
};

/// A page as files, and the decisions for it.
struct WebPage {
  std::map<std::string, std::string> files;  ///< relative path → bytes
  std::size_t triangles = 0;
  std::vector<std::string> decisions;  ///< the parts of the page, carried or left out, with reasons
};

/// Whether a published folder has a file of this relative path.
bool is_page_file(const std::filesystem::path& path);

/// Makes a page that shows the visible nodes of a scene by Rebake's rule. It carries only the shaders and data that the
/// scene calls for; keyframes of places and of the camera are sampled 30 times per second, and bends are poses.
/// `before`: the scene before the edits, which the page then can show too; files that both need are carried once.
/// Throws EditError if nothing is visible, DeviceError and FileError if the files of the page are missing.
WebPage web_page(const LitScene& scene, const WebPageOptions& options, const Progress& progress = {},
                 const std::optional<LitScene>& before = std::nullopt);

}  // namespace rebake
