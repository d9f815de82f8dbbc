#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "editor/actions/session.h"
#include "mesh_ops/scene/camera.h"
#include "render/frame/plan.h"

namespace rebake {

/// Numbers written as x,y,z. Throws FieldError naming the option.
Vec3 parse_vec3(const std::string& text, const char* option);

/// --axes 360|forward
void add_axes_option(CLI::App& command, Axes& axes);

/// Reads folders into one scene, names made unique.
Scene read_all(const std::vector<std::string>& folders, Axes axes, const Progress& progress);

/// Camera and raster options of commands that render.
struct ViewOptions {
  std::string size = "800x800", eye, target, up, camera_file, background;
  std::optional<double> fov, near_plane, far_plane;
  int samples = 4;
  std::string weights = "automatic", shading = "automatic", precision = "full";

  void add_to(CLI::App& command);
  /// The view on `scene`: the options over the camera file, or over a camera that frames the scene. Throws FieldError,
  /// FileError.
  View view(const Scene& scene) const;
  RenderOptions render_options() const;
  void set_background(Scene& scene) const;
};

}  // namespace rebake
