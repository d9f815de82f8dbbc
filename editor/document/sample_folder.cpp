#include "editor/document/sample_folder.h"

namespace rebake {

std::filesystem::path sample_folder() {
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::filesystem::path installed = program.parent_path().parent_path() / REBAKE_INSTALLED_SAMPLES;
  for (const std::filesystem::path& folder : {installed, std::filesystem::path(REBAKE_SOURCE_SAMPLES)})
    if (std::filesystem::is_directory(folder, error)) return folder;
  return {};
}

}  // namespace rebake
