#include "editor/cli/version.h"

#include "rebake_commit.h"

namespace rebake {

std::string program_version() {
  const std::string commit = REBAKE_COMMIT;
  return "rebake " REBAKE_VERSION + (commit.empty() ? "" : " (" + commit + ")");
}

}  // namespace rebake
