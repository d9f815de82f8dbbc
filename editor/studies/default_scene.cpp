#include "editor/studies/default_scene.h"

#include "editor/document/sample_folder.h"
#include "mesh_ops/base/error.h"

namespace rebake {

std::filesystem::path default_study_scene() {
  std::error_code error;
  const std::filesystem::path folder = sample_folder() / "ficus";
  if (!std::filesystem::is_directory(folder, error))
    throw Error("the sample scene \"ficus\" was not found; pass a scene with --scene");
  return folder;
}

}  // namespace rebake
