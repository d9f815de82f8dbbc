#include "editor/studies/default_scene.h"

#include "mesh_ops/base/error.h"

namespace rebake {

std::filesystem::path default_study_scene() {
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::filesystem::path installed = program.parent_path().parent_path() / REBAKE_INSTALLED_SAMPLES / "ficus";
  for (const std::filesystem::path& folder : {installed, std::filesystem::path(REBAKE_SOURCE_SAMPLES) / "ficus"})
    if (std::filesystem::is_directory(folder, error)) return folder;
  throw Error("the sample scene is not found; name one with --scene");
}

}  // namespace rebake
