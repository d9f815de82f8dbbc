#pragma once

#include <optional>
#include <string>
#include <vector>

#include "editor/cli/field_options.h"
#include "editor/cli/subcommand.h"
#include "mesh_ops/base/progress.h"
#include "mesh_ops/base/source_guard.h"
#include "mesh_ops/formats/mobilenerf/baked_folder.h"
#include "mesh_ops/scene/scene.h"
#include "render/graph/plan.h"

namespace rebake {

/// Parses "x,y,z". Throws FieldError for the option `option`.
Vec3 parse_vec3(const std::string& text, const char* option);

/// Options that tell how MobileNeRF folders are read: --axes, and the dialects of other tools. They are fields of the
/// edit `import`.
class FolderOptions {
 public:
  /// This object must outlive the subcommand's parsing.
  void add_to(SubcommandDescription& command);
  /// Throws FieldError.
  ReadOptions read() const;

 private:
  FieldOptions fields_;
};

/// All folders, scenes and projects of a command line in one scene, with unique node names.
struct LoadedScene {
  Scene scene;
  SourceGuard sources;  ///< files and folders that must not be overwritten
};
LoadedScene load_scenes(const std::vector<std::string>& folders, const FolderOptions& how, const Progress& progress);

/// Camera and rendering options of subcommands that render, as given: eye, target, up and background as "x,y,z", size
/// as "WxH", the others as words of RenderOptions. view() and render_options() parse them.
struct ViewOptions {
  std::string size = "800x800", eye, target, up, camera_file, background;
  std::optional<double> fov, near_plane, far_plane;
  int samples = 4;
  std::string weights = "automatic", shading = "automatic", precision = "full", occlusion = "automatic",
              texels = "automatic";

  /// Adds the options to a subcommand.
  void add_to(SubcommandDescription& command);
  /// Starts from the camera file or the stored view that --camera names, else from a camera that frames the scene.
  /// Options override its fields. Throws FieldError, FileError.
  View view(const Scene& scene) const;
  /// Width and height. Throws FieldError.
  std::pair<int, int> pixels() const;
  RenderOptions render_options() const;
  /// Sets the scene's background if --background is given. Throws FieldError.
  void set_background(Scene& scene) const;
  /// Protects the camera file, if one is given.
  void protect_files(SourceGuard& sources) const;
};

}  // namespace rebake
