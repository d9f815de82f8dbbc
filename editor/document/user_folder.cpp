#include "editor/document/user_folder.h"

#include <cstdlib>

namespace rebake {

namespace fs = std::filesystem;

std::optional<fs::path> user_folder(const char* variable, const char* below_home) {
  if (const char* given = std::getenv(variable); given != nullptr && fs::path(given).is_absolute()) return given;
  const char* home = std::getenv("HOME");
  return home != nullptr && fs::path(home).is_absolute() ? std::optional(fs::path(home) / below_home) : std::nullopt;
}

}  // namespace rebake
