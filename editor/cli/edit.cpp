#include <memory>

#include "editor/cli/commands.h"
#include "editor/gui/window/editor_window.h"

namespace rebake {

void describe_edit(CommandDescription& command) {
  auto paths = std::make_shared<std::vector<std::string>>();
  command.option("paths", *paths, "what to open: folders and scenes together, or one project",
                 "FOLDER|SCENE|PROJECT...");
  command.does([paths] { run_editor(*paths); });
}

}  // namespace rebake
