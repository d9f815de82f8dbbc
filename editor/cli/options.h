#pragma once

#include <optional>
#include <string>
#include <vector>

#include "editor/cli/command.h"
#include "mesh_ops/base/progress.h"
#include "mesh_ops/base/source_guard.h"
#include "mesh_ops/scene/scene.h"
#include "render/graph/plan.h"

namespace rebake {

/// Numbers written as x,y,z. Throws FieldError naming the option.
Vec3 parse_vec3(const std::string& text, const char* option);

/// --axes 360|forward
void add_axes_option(CommandDescription& command, std::string& axes);
Axes axes_of(const std::string& word);

/// What a command line names, in one scene; names made unique.
struct Opened {
  Scene scene;
  SourceGuard sources;  ///< where nothing may be written
};
Opened read_all(const std::vector<std::string>& folders, const std::string& axes, const Progress& progress);

/// Camera and raster options of commands that render.
struct ViewOptions {
  std::string size = "800x800", eye, target, up, camera_file, background;
  std::optional<double> fov, near_plane, far_plane;
  int samples = 4;
  std::string weights = "automatic", shading = "automatic", precision = "full", occlusion = "automatic",
              texels = "automatic";

  void add_to(CommandDescription& command);
  /// The view on `scene`: the options over the camera file, or over a camera that frames the scene. Throws FieldError,
  /// FileError.
  View view(const Scene& scene) const;
  RenderOptions render_options() const;
  void set_background(Scene& scene) const;
  /// Protects the camera file, if one is given.
  void protect_files(SourceGuard& sources) const;
};

}  // namespace rebake
